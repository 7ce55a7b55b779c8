// A joint that ends on another: "abutting" (x = at, below) meets "through" (z = 0.5) from below.
// Three blocks, three sectors along the line where they meet.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.15, Name "h"}   // cell size, m
  at = {0.5, Name "at"}  // x of the abutting joint, 0.2 to 0.8
];

eps = 1e-4;

// A rectangle is born in the plane z = const; the abutting one is turned upright about its edge x = at.
Box(1) = {0, 0, 0, 1, 1, 1};
plane_through = news;
Rectangle(plane_through) = {0, 0, 0.5, 1, 1};
plane_abutting = news;
Rectangle(plane_abutting) = {at, 0, 0, 0.5, 1};
Rotate {{0, 1, 0}, {at, 0, 0}, -Pi / 2} { Surface{plane_abutting}; }

// Make the mesh conform to both joints and to the line where they meet.
BooleanFragments{ Volume{1}; Delete; }{ Surface{plane_through, plane_abutting}; Delete; }

left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, 1 + eps};
right() = Surface In BoundingBox {1 - eps, -eps, -eps, 1 + eps, 1 + eps, 1 + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, eps, 1 + eps};
back() = Surface In BoundingBox {-eps, 1 - eps, -eps, 1 + eps, 1 + eps, 1 + eps};
bottom() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, 1 + eps, eps};
top() = Surface In BoundingBox {-eps, -eps, 1 - eps, 1 + eps, 1 + eps, 1 + eps};
through() = Surface In BoundingBox {-eps, -eps, 0.5 - eps, 1 + eps, 1 + eps, 0.5 + eps};
abutting() = Surface In BoundingBox {at - eps, -eps, -eps, at + eps, 1 + eps, 0.5 + eps};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("through") = through();
Physical Surface("abutting") = abutting();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
