// Two blocks of width 1 on a slope, in the plane, turned so that the slope is level: a slender one above leans on a low
// one below it (on the left). Gravity is turned instead.
DefineConstant[
  h = {0.1, Name "h"}            // cell size, m
  low = {1, Name "low"}          // height of the lower block, m
  tall = {3, Name "tall"}        // height of the upper block, m
];

Point(1) = {-1, -1, 0};
Point(2) = {3, -1, 0};
Point(3) = {3, 0, 0};
Point(4) = {2, 0, 0};
Point(5) = {1, 0, 0};
Point(6) = {0, 0, 0};
Point(7) = {-1, 0, 0};
Point(8) = {0, low, 0};
Point(9) = {1, low, 0};
Point(10) = {1, tall, 0};
Point(11) = {2, tall, 0};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Line(7) = {7, 1};
Line(8) = {6, 8};
Line(9) = {8, 9};
Line(10) = {9, 5};
Line(11) = {9, 10};
Line(12) = {10, 11};
Line(13) = {11, 4};

Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7};
Plane Surface(1) = {1};
Curve Loop(2) = {-5, -10, -9, -8};
Plane Surface(2) = {2};
Curve Loop(3) = {-4, -13, -12, -11, 10};
Plane Surface(3) = {3};

Physical Surface("slope") = {1};
Physical Surface("lower") = {2};
Physical Surface("upper") = {3};
Physical Curve("lower_base") = {5};
Physical Curve("upper_base") = {4};
Physical Curve("side") = {10};
Physical Curve("bottom") = {1};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
