// Two vertical joints that cross along the line x = y = 0.5: four blocks, four sectors at the crossing.
// "east" is the plane x = 0.5; "north" makes `angle` degrees with it (90: the plane y = 0.5).
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.15, Name "h"}        // cell size, m
  angle = {90, Name "angle"}  // degrees between the joints, 50 to 130
];

eps = 1e-4;

// The rock, and two planes larger than the rock, cut to it. A rectangle is born in the plane z = 0.
Box(1) = {0, 0, 0, 1, 1, 1};
plane_east = news;
Rectangle(plane_east) = {-2, -2, 0, 4, 4};
Rotate {{0, 1, 0}, {0, 0, 0}, Pi / 2} { Surface{plane_east}; }
plane_north = news;
Rectangle(plane_north) = {-2, -2, 0, 4, 4};
Rotate {{0, 1, 0}, {0, 0, 0}, Pi / 2} { Surface{plane_north}; }
Rotate {{0, 0, 1}, {0, 0, 0}, angle * Pi / 180} { Surface{plane_north}; }
Translate {0.5, 0.5, 0.5} { Surface{plane_east, plane_north}; }
cut_east() = BooleanIntersection{ Surface{plane_east}; Delete; }{ Volume{1}; };
cut_north() = BooleanIntersection{ Surface{plane_north}; Delete; }{ Volume{1}; };

// Make the mesh conform to both joints and to the line where they cross.
BooleanFragments{ Volume{1}; Delete; }{ Surface{cut_east(), cut_north()}; Delete; }

// Outer faces and "east" by where they lie; whatever is left is "north".
left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, 1 + eps};
right() = Surface In BoundingBox {1 - eps, -eps, -eps, 1 + eps, 1 + eps, 1 + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, eps, 1 + eps};
back() = Surface In BoundingBox {-eps, 1 - eps, -eps, 1 + eps, 1 + eps, 1 + eps};
bottom() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, 1 + eps, eps};
top() = Surface In BoundingBox {-eps, -eps, 1 - eps, 1 + eps, 1 + eps, 1 + eps};
east() = Surface In BoundingBox {0.5 - eps, -eps, -eps, 0.5 + eps, 1 + eps, 1 + eps};
north() = Surface{:};
north() -= {left(), right(), front(), back(), bottom(), top(), east()};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("east") = east();
Physical Surface("north") = north();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
