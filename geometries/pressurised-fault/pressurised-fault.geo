// A fault of half-length 1 in the plane z = 0, through a slice of a large plate: plane strain if the faces `front` and
// `back` do not move along y. One layer of prisms, whatever the thickness.
// Cells are `h` at the crack fronts and grow with the distance from them up to `h_far`.
DefineConstant[
  h = {0.02, Name "h"}           // cell size at the crack fronts, m
  grow = {0.15, Name "grow"}     // growth of the cell size per metre of distance
  h_far = {4, Name "h_far"}      // largest cell size, m
  half = {20, Name "half"}       // half the side of the plate, m
  thick = {0.1, Name "thick"}    // thickness of the slice, m
];

Point(1) = {-half, 0, -half};
Point(2) = {half, 0, -half};
Point(3) = {half, 0, 0};
Point(4) = {half, 0, half};
Point(5) = {-half, 0, half};
Point(6) = {-half, 0, 0};
Point(7) = {-1, 0, 0};
Point(8) = {1, 0, 0};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Line(7) = {6, 7};
Line(8) = {7, 8};
Line(9) = {8, 3};

Curve Loop(1) = {1, 2, -9, -8, -7, 6};
Curve Loop(2) = {3, 4, 5, 7, 8, 9};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Extrude {0, thick, 0} { Surface{1, 2}; Layers{1}; }

eps = 1e-4 * thick;
a = -half - eps;
b = half + eps;
c = thick + eps;
Physical Volume("rock") = Volume{:};
Physical Surface("left") = Surface In BoundingBox {a, -eps, a, -half + eps, c, b};
Physical Surface("right") = Surface In BoundingBox {half - eps, -eps, a, b, c, b};
Physical Surface("front") = Surface In BoundingBox {a, -eps, a, b, eps, b};
Physical Surface("back") = Surface In BoundingBox {a, thick - eps, a, b, c, b};
Physical Surface("bottom") = Surface In BoundingBox {a, -eps, a, b, c, -half + eps};
Physical Surface("top") = Surface In BoundingBox {a, -eps, half - eps, b, c, b};
Physical Surface("crack") = Surface In BoundingBox {-1 - eps, -eps, -eps, 1 + eps, c, eps};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * sqrt((abs(x) - 1)^2 + z*z)", h, grow);
Background Field = 1;
Mesh.MeshSizeMax = h_far;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
