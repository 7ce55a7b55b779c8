// The Moebius strip of five triangles {i, i+1, i+2}, embedded in a box. Corners 1 and 3 are the
// tips of a double pyramid over the triangle of corners 2, 4 and 5.
h = 1;
Point(1) = {0, 0, 1, h};
Point(2) = {1, 0, 0, h};
Point(3) = {0, 0, -1, h};
Point(4) = {-0.5, 0.8, 0, h};
Point(5) = {-0.5, -0.8, 0, h};
Line(12) = {1, 2};
Line(23) = {2, 3};
Line(34) = {3, 4};
Line(45) = {4, 5};
Line(51) = {5, 1};
Line(13) = {1, 3};
Line(24) = {2, 4};
Line(35) = {3, 5};
Line(41) = {4, 1};
Line(52) = {5, 2};
Curve Loop(1) = {12, 23, -13};
Curve Loop(2) = {23, 34, -24};
Curve Loop(3) = {34, 45, -35};
Curve Loop(4) = {45, 51, -41};
Curve Loop(5) = {51, 12, -52};
For i In {1 : 5}
  Plane Surface(i) = {i};
EndFor

Point(11) = {-3, -3, -3, h};
base[] = Extrude{6, 0, 0} { Point{11}; };
side[] = Extrude{0, 6, 0} { Curve{base[1]}; };
box[] = Extrude{0, 0, 6} { Surface{side[1]}; };
Surface{1 : 5} In Volume{box[1]};

Physical Volume("rock") = {box[1]};
Physical Surface("joint") = {1 : 5};
Physical Surface("bottom") = {side[1]};
Physical Surface("top") = {box[0]};
