// A spherical joint of radius 1 around a core, in a shell of outer radius 2.
SetFactory("OpenCASCADE");

DefineConstant[ h = {0.25, Name "h"} ]; // cell size, m

Sphere(1) = {0, 0, 0, 2};
Sphere(2) = {0, 0, 0, 1};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }

a = 1 + 1e-3;
b = 2 + 1e-3;
core() = Volume In BoundingBox {-a, -a, -a, a, a, a};
shell() = Volume{:};
shell() -= core();
joint() = Surface In BoundingBox {-a, -a, -a, a, a, a};
outside() = Surface{:};
outside() -= joint();

Physical Volume("core") = core();
Physical Volume("shell") = shell();
Physical Surface("joint") = joint();
Physical Surface("outside") = outside();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
Mesh.HighOrderOptimize = 1; // with order = 2: curved cells beside the surface would fold over themselves
