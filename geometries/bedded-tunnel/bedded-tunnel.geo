// A circular hole of radius 1 m in a large plate, in the plane: a tunnel, a scene in plane strain.
// Cells are `h` at the wall and grow with the distance from it up to `h_far`.
DefineConstant[
  h = {0.06, Name "h"}           // cell size at the wall, m
  grow = {0.2, Name "grow"}      // growth of the cell size per metre of distance
  h_far = {12, Name "h_far"}     // largest cell size, m
  half = {80, Name "half"}       // half the side of the plate, m
];

Point(1) = {-half, -half, 0};
Point(2) = {half, -half, 0};
Point(3) = {half, half, 0};
Point(4) = {-half, half, 0};
Point(5) = {0, 0, 0};
Point(6) = {1, 0, 0};
Point(7) = {0, 1, 0};
Point(8) = {-1, 0, 0};
Point(9) = {0, -1, 0};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Circle(5) = {6, 5, 7};
Circle(6) = {7, 5, 8};
Circle(7) = {8, 5, 9};
Circle(8) = {9, 5, 6};

Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {5, 6, 7, 8};
Plane Surface(1) = {1, 2};

Physical Surface("shale") = {1};
Physical Curve("far") = {1, 2, 3, 4};
Physical Curve("wall") = {5, 6, 7, 8};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * abs(sqrt(x*x + y*y) - 1)", h, grow);
Background Field = 1;
Mesh.MeshSizeMax = h_far;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
