// A box cut by a rectangle.
SetFactory("OpenCASCADE");
DefineConstant[ size = {1, Name "size"} ];
Box(1) = {0, 0, 0, size, size, size};
Rectangle(7) = {0, 0, size / 2, size, size};
BooleanFragments{ Volume{1}; Delete; }{ Surface{7}; Delete; }
Physical Volume("rock") = Volume{:};
