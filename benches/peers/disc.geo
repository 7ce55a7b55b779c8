// A disc inside a cube of 1 m: radius 0.25 m, dip 50 degrees, rising with x. For the comparison with other programs.
SetFactory("OpenCASCADE");

DefineConstant[ h = {0.06, Name "h"} ];            // cell size, m

Box(1) = {0, 0, 0, 1, 1, 1};
d = news;
Disk(d) = {0.5, 0.5, 0.5, 0.25, 0.25};
Rotate {{0, 1, 0}, {0.5, 0.5, 0.5}, -50 * Pi / 180} { Surface{d}; }
BooleanFragments{ Volume{1}; Delete; }{ Surface{d}; Delete; }

eps = 1e-4;
Physical Volume("rock") = Volume{:};
Physical Surface("fracture") = Surface In BoundingBox {0.2, 0.2, 0.2, 0.8, 0.8, 0.8};
Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
