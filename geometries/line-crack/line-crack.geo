// A crack of half-length 1 on the line y = 0 through a large plate, in the plane: a scene in plane strain.
// Cells are `h` at the crack fronts and grow with the distance from them up to `h_far`.
DefineConstant[
  h = {0.02, Name "h"}           // cell size at the crack fronts, m
  grow = {0.15, Name "grow"}     // growth of the cell size per metre of distance
  h_far = {4, Name "h_far"}      // largest cell size, m
  half = {20, Name "half"}       // half the side of the plate, m
];

Point(1) = {-half, -half, 0};
Point(2) = {half, -half, 0};
Point(3) = {half, half, 0};
Point(4) = {-half, half, 0};
Point(5) = {-1, 0, 0};
Point(6) = {1, 0, 0};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Line(5) = {5, 6};

Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Line{5} In Surface{1};

Physical Surface("rock") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Curve("crack") = {5};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * sqrt((abs(x) - 1)^2 + y*y)", h, grow);
Background Field = 1;
Mesh.MeshSizeMax = h_far;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
