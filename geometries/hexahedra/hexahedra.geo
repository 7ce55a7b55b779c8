// Three joints that cross in a block of hexahedra: eight blocks, eight sectors at one point. "east" is the plane x = 0.5,
// "bed" the plane z = 0.5, "north" makes `angle` degrees with "east" (90: the plane y = 0.5).
DefineConstant[
  n = {6, Name "n"}           // cells along half an edge
  angle = {60, Name "angle"}  // degrees between east and north, 50 to 130
];

// Four quadrangles in the plane z = 0: corners, middles of edges, middle. North leaves through left and right.
rise = 0.5 / Tan(angle * Pi / 180);
Point(1) = {0, 0, 0};
Point(2) = {0.5, 0, 0};
Point(3) = {1, 0, 0};
Point(4) = {0, 0.5 + rise, 0};
Point(5) = {0.5, 0.5, 0};
Point(6) = {1, 0.5 - rise, 0};
Point(7) = {0, 1, 0};
Point(8) = {0.5, 1, 0};
Point(9) = {1, 1, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 5};
Line(4) = {5, 6};
Line(5) = {7, 8};
Line(6) = {8, 9};
Line(7) = {1, 4};
Line(8) = {4, 7};
Line(9) = {2, 5};
Line(10) = {5, 8};
Line(11) = {3, 6};
Line(12) = {6, 9};
Curve Loop(1) = {1, 9, -3, -7};
Curve Loop(2) = {2, 11, -4, -9};
Curve Loop(3) = {3, 10, -5, -8};
Curve Loop(4) = {4, 12, -6, -10};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Plane Surface(4) = {4};
Transfinite Curve{:} = n + 1;
Transfinite Surface{:};
Recombine Surface{:};

// Up to the bed and on to the top.
eps = 1e-4;
Extrude {0, 0, 0.5} { Surface{1:4}; Layers{n}; Recombine; }
bed() = Surface In BoundingBox {-eps, -eps, 0.5 - eps, 1 + eps, 1 + eps, 0.5 + eps};
Extrude {0, 0, 0.5} { Surface{bed()}; Layers{n}; Recombine; }

left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, 1 + eps};
right() = Surface In BoundingBox {1 - eps, -eps, -eps, 1 + eps, 1 + eps, 1 + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, eps, 1 + eps};
back() = Surface In BoundingBox {-eps, 1 - eps, -eps, 1 + eps, 1 + eps, 1 + eps};
bottom() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, 1 + eps, eps};
top() = Surface In BoundingBox {-eps, -eps, 1 - eps, 1 + eps, 1 + eps, 1 + eps};
east() = Surface In BoundingBox {0.5 - eps, -eps, -eps, 0.5 + eps, 1 + eps, 1 + eps};
north() = Surface{:};
north() -= {left(), right(), front(), back(), bottom(), top(), east(), bed()};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("east") = east();
Physical Surface("north") = north();
Physical Surface("bed") = bed();
