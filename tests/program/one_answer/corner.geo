// A thin corner of a box that a fracture cuts off but for a short edge, on which it turns.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 10, 9, 8};
Point(101) = {10, 0, 7.867836427763084};
Point(102) = {10, 0.6926193986354543, 7.897953162951358};
Point(103) = {9.020444272841008, 1.2199797029492636, 8};
Point(104) = {8.363647676622886, 0, 8};
Line(101) = {101, 102}; Line(102) = {102, 103}; Line(103) = {103, 104}; Line(104) = {104, 101};
Curve Loop(101) = {101 : 104};
Plane Surface(101) = {101};
BooleanFragments{ Volume{1}; Delete; }{ Surface{101}; Delete; }
e = 1e-5;
f() = Surface In BoundingBox{8.3, -e, 7.8, 10 + e, 1.3, 8 + e};
left() = Surface In BoundingBox{-e, -e, -e, e, 9 + e, 8 + e};
right() = Surface In BoundingBox{10 - e, -e, -e, 10 + e, 9 + e, 8 + e};
front() = Surface In BoundingBox{-e, -e, -e, 10 + e, e, 8 + e};
back() = Surface In BoundingBox{-e, 9 - e, -e, 10 + e, 9 + e, 8 + e};
bottom() = Surface In BoundingBox{-e, -e, -e, 10 + e, 9 + e, e};
top() = Surface In BoundingBox{-e, -e, 8 - e, 10 + e, 9 + e, 8 + e};
f() -= {right(), front(), top()};
Physical Volume("rock") = Volume{:};
Physical Surface("left") = left(); Physical Surface("right") = right();
Physical Surface("front") = front(); Physical Surface("back") = back();
Physical Surface("bottom") = bottom(); Physical Surface("top") = top();
Physical Surface("f") = f();
Mesh.MeshSizeMax = 3;
MeshSize{PointsOf{Surface{f()};}} = 0.35;
