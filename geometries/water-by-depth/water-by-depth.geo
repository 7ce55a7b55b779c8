// A block of 2 x 1 x 10 m, cut in the middle by a joint that stands upright.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {1, Name "h"}   // cell size, m
];

eps = 1e-4;

Box(1) = {0, 0, 0, 1, 1, 10};
Box(2) = {1, 0, 0, 1, 1, 10};
BooleanFragments{ Volume{1, 2}; Delete; }{}

left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, 10 + eps};
right() = Surface In BoundingBox {2 - eps, -eps, -eps, 2 + eps, 1 + eps, 10 + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 2 + eps, eps, 10 + eps};
back() = Surface In BoundingBox {-eps, 1 - eps, -eps, 2 + eps, 1 + eps, 10 + eps};
joint() = Surface In BoundingBox {1 - eps, -eps, -eps, 1 + eps, 1 + eps, 10 + eps};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("joint") = joint();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
