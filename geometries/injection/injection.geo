// Three joints in a cube of rock of 10 m: a level one that reaches the face `right`, an upright one across it, and one that
// dips 60 degrees and crosses the level one.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {1.5, Name "h"}             // cell size away from the joints, m
  h_joint = {0.6, Name "h_joint"} // on them, m
];

eps = 1e-4;

Box(1) = {0, 0, 0, 10, 10, 10};

bed = news;
Rectangle(bed) = {1, 1, 5, 9, 8};
steep = news;
Rectangle(steep) = {-3, -3, 0, 6, 6};
Rotate {{0, 1, 0}, {0, 0, 0}, Pi / 2} { Surface{steep}; }
Translate {3.5, 5, 5} { Surface{steep}; }
dipping = news;
Rectangle(dipping) = {-2.5, -2.5, 0, 5, 5};
Rotate {{0, 1, 0}, {0, 0, 0}, Pi / 3} { Surface{dipping}; }
Translate {7, 5, 5.5} { Surface{dipping}; }

// Make the mesh conform to the joints and to the lines where they cross.
parts() = BooleanFragments{ Volume{1}; Delete; }{ Surface{bed, steep, dipping}; Delete; };

left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 10 + eps, 10 + eps};
right() = Surface In BoundingBox {10 - eps, -eps, -eps, 10 + eps, 10 + eps, 10 + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 10 + eps, eps, 10 + eps};
back() = Surface In BoundingBox {-eps, 10 - eps, -eps, 10 + eps, 10 + eps, 10 + eps};
bottom() = Surface In BoundingBox {-eps, -eps, -eps, 10 + eps, 10 + eps, eps};
top() = Surface In BoundingBox {-eps, -eps, 10 - eps, 10 + eps, 10 + eps, 10 + eps};
on_bed() = Surface In BoundingBox {1 - eps, 1 - eps, 5 - eps, 10 + eps, 9 + eps, 5 + eps};
on_steep() = Surface In BoundingBox {3.5 - eps, 2 - eps, 2 - eps, 3.5 + eps, 8 + eps, 8 + eps};
inner() = Surface{:};
inner() -= {left(), right(), front(), back(), bottom(), top(), on_bed(), on_steep()};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("bed") = on_bed();
Physical Surface("steep") = on_steep();
Physical Surface("dipping") = inner();

// Small cells at the joints.
Field[1] = Distance;
Field[1].SurfacesList = {on_bed(), on_steep(), inner()};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = h_joint;
Field[2].SizeMax = h;
Field[2].DistMin = 0;
Field[2].DistMax = 3;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
