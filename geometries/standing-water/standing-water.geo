// A column of 1 x 1 x 10 m, cut from its top to its bottom by a steep joint, and by a bed that crosses it.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.5, Name "h"}      // cell size, m
  dip = {85, Name "dip"}   // of the joint, degrees, 85 to 90
];

eps = 1e-4;

Box(1) = {0, 0, 0, 1, 1, 10};
plane = news;
Rectangle(plane) = {-10, -10, 0, 20, 20};
Rotate {{0, 1, 0}, {0, 0, 0}, dip * Pi / 180} { Surface{plane}; }
Translate {0.5, 0.5, 5} { Surface{plane}; }
joint() = BooleanIntersection{ Surface{plane}; Delete; }{ Volume{1}; };
bed = news;
Rectangle(bed) = {0, 0, 4, 1, 1};
BooleanFragments{ Volume{1}; Delete; }{ Surface{joint(), bed}; Delete; }

top() = Surface In BoundingBox {-eps, -eps, 10 - eps, 1 + eps, 1 + eps, 10 + eps};
bottom() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, 1 + eps, eps};
left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, 10 + eps};
right() = Surface In BoundingBox {1 - eps, -eps, -eps, 1 + eps, 1 + eps, 10 + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, eps, 10 + eps};
back() = Surface In BoundingBox {-eps, 1 - eps, -eps, 1 + eps, 1 + eps, 10 + eps};
of_bed() = Surface In BoundingBox {-eps, -eps, 4 - eps, 1 + eps, 1 + eps, 4 + eps};
of_joint() = Surface{:};
of_joint() -= {top(), bottom(), left(), right(), front(), back(), of_bed()};

Physical Volume("rock") = Volume{:};
Physical Surface("top") = top();
Physical Surface("joint") = of_joint();
Physical Surface("bed") = of_bed();

Mesh.MeshSizeMin = h / 2;
Mesh.MeshSizeMax = h;
