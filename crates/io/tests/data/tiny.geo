SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Rectangle(20) = {0, 0, 0.5, 1, 1};
BooleanFragments{ Volume{1}; Delete; }{ Surface{20}; Delete; }
MeshSize{:} = 2;
Physical Volume("rock", 1) = {1, 2};
Physical Surface("joint one", 5) = {20};
Physical Surface("all", 6) = {20, -21};
Physical Surface(7) = {22};
