// One planar joint through the centre of a column, dipping `dip` degrees towards the left (it rises with x).
// It strikes along y and leaves the column through left, right, front and back, never through top or bottom.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.2, Name "h"}       // cell size, m
  dip = {50, Name "dip"}    // degrees, 20 to 60
];

eps = 1e-4;
height = 2;

// The rock, and a joint plane larger than the rock, cut to it.
Box(1) = {0, 0, 0, 1, 1, height};
plane = news;
Rectangle(plane) = {-4, -4, 0, 8, 8};
Rotate {{0, 1, 0}, {0, 0, 0}, -dip * Pi / 180} { Surface{plane}; }
Translate {0.5, 0.5, height / 2} { Surface{plane}; }
cut() = BooleanIntersection{ Surface{plane}; Delete; }{ Volume{1}; };

// Make the mesh conform to the joint.
BooleanFragments{ Volume{1}; Delete; }{ Surface{cut()}; Delete; }

// Outer faces by where they lie; whatever is left is the joint.
left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, height + eps};
right() = Surface In BoundingBox {1 - eps, -eps, -eps, 1 + eps, 1 + eps, height + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, eps, height + eps};
back() = Surface In BoundingBox {-eps, 1 - eps, -eps, 1 + eps, 1 + eps, height + eps};
bottom() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, 1 + eps, eps};
top() = Surface In BoundingBox {-eps, -eps, height - eps, 1 + eps, 1 + eps, height + eps};
joint() = Surface{:};
joint() -= {left(), right(), front(), back(), bottom(), top()};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("joint") = joint();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
