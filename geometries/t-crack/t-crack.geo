// A crack of length 100 on the line x = 0, which ends on a crack of length 50 on the line y = 50, in the plane.
// Cells are `h` around the crack that is ended on and at the other front, and grow with the distance up to `h_far`.
DefineConstant[
  h = {0.25, Name "h"}           // cell size at the junction and the fronts, m
  grow = {0.12, Name "grow"}     // growth of the cell size per metre of distance
  h_far = {40, Name "h_far"}     // largest cell size, m
  half = {500, Name "half"}      // half the side of the plate, m
];

Point(1) = {-half, -half, 0};
Point(2) = {half, -half, 0};
Point(3) = {half, half, 0};
Point(4) = {-half, half, 0};
// Ends, the junction, and where the tables have values: nodes of the mesh.
ys[] = {-50, -40.9, 29.8};
xs[] = {-25, -16.5, -10.6, -6.5, -3.8, 0, 3.8, 6.5, 10.6, 16.5, 25};
For i In {0 : 2}
  Point(10 + i) = {0, ys[i], 0};
EndFor
For i In {0 : 10}
  Point(20 + i) = {xs[i], 50, 0};
EndFor

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Line(10) = {10, 11};
Line(11) = {11, 12};
Line(12) = {12, 25};
For i In {0 : 9}
  Line(20 + i) = {20 + i, 21 + i};
EndFor

Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Line{10 : 12, 20 : 29} In Surface{1};

Physical Surface("rock") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Curve("open") = {10 : 12};
Physical Curve("closed") = {20 : 29};

// Distance to the fronts and the junction, closed form.
Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * sqrt(x*x + (y + 50)^2)", h, grow);
Field[2] = MathEval;
Field[2].F = Sprintf("%g + %g * sqrt(x*x + (y - 50)^2)", h, grow);
Field[3] = MathEval;
Field[3].F = Sprintf("%g + %g * sqrt((abs(x) - 25)^2 + (y - 50)^2)", h, grow);
Field[4] = Min;
Field[4].FieldsList = {1, 2, 3};
Background Field = 4;
Mesh.MeshSizeMax = h_far;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
