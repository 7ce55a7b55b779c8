// Two cracks of length 2 on the line y = 0, `gap` apart, in the plane.
// Cells are `h` at the four fronts and grow with the distance from them up to `h_far`.
DefineConstant[
  gap = {1, Name "gap"}          // distance of the inner fronts, m
  h = {0.02, Name "h"}           // cell size at the crack fronts, m
  grow = {0.15, Name "grow"}     // growth of the cell size per metre of distance
  h_far = {4, Name "h_far"}      // largest cell size, m
  half = {20, Name "half"}       // half the side of the plate, m
];

Point(1) = {-half, -half, 0};
Point(2) = {half, -half, 0};
Point(3) = {half, half, 0};
Point(4) = {-half, half, 0};
Point(5) = {-gap / 2 - 2, 0, 0};
Point(6) = {-gap / 2, 0, 0};
// Fronts, and where the scene has probes: nodes of the mesh.
behind[] = {0, 0.05, 0.1, 1, 1.9, 1.95, 2};
For i In {0 : 6}
  Point(10 + i) = {gap / 2 + behind[i], 0, 0};
EndFor

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Line(5) = {5, 6};
For i In {0 : 5}
  Line(10 + i) = {10 + i, 11 + i};
EndFor

Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Line{5, 10 : 15} In Surface{1};

Physical Surface("rock") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Curve("west") = {5};
Physical Curve("east") = {10 : 15};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * abs(sqrt((abs(x) - %g)^2 + y*y))", h, grow, gap / 2);
Field[2] = MathEval;
Field[2].F = Sprintf("%g + %g * abs(sqrt((abs(x) - %g)^2 + y*y))", h, grow, gap / 2 + 2);
Field[3] = Min;
Field[3].FieldsList = {1, 2};
Background Field = 3;
Mesh.MeshSizeMax = h_far;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
