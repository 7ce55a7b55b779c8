// A listric fault: steep at the top, flat at depth, bulging along strike. It cuts a block from the top to the right.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.08, Name "h"}         // cell size, m
  bulge = {0.15, Name "bulge"} // how far the fault wanders along y, m
];

eps = 1e-3;

Box(1) = {0, 0, 0, 2, 1, 1};

// Five sections of the fault from y = -0.2 to y = 1.2, each a spline longer than the block, and a smooth surface through
// them.
loops() = {};
For i In {0:4}
  y = -0.2 + 0.35 * i;
  s = bulge * Sin(Pi * i / 2);
  p = newp;
  Point(p) = {0.50 + s, y, 1.20};
  Point(p + 1) = {0.62 + s, y, 0.85};
  Point(p + 2) = {0.85 + s, y, 0.52};
  Point(p + 3) = {1.25 + s, y, 0.33};
  Point(p + 4) = {1.75 + s, y, 0.27};
  Point(p + 5) = {2.40 + s, y, 0.25};
  c = newc;
  Spline(c) = {p:p + 5};
  w = newll;
  Wire(w) = {c};
  loops() += w;
EndFor
fault() = ThruSections{loops()};
cut() = BooleanIntersection{ Surface{fault()}; Delete; }{ Volume{1}; };
BooleanFragments{ Volume{1}; Delete; }{ Surface{cut()}; Delete; }

a = -eps;
left() = Surface In BoundingBox {a, a, a, eps, 1 + eps, 1 + eps};
right() = Surface In BoundingBox {2 - eps, a, a, 2 + eps, 1 + eps, 1 + eps};
front() = Surface In BoundingBox {a, a, a, 2 + eps, eps, 1 + eps};
back() = Surface In BoundingBox {a, 1 - eps, a, 2 + eps, 1 + eps, 1 + eps};
bottom() = Surface In BoundingBox {a, a, a, 2 + eps, 1 + eps, eps};
top() = Surface In BoundingBox {a, a, 1 - eps, 2 + eps, 1 + eps, 1 + eps};
fault() = Surface{:};
fault() -= {left(), right(), front(), back(), bottom(), top()};

// The fault parts the top: the hanging wall has the piece that does not reach x = 0.
hanging() = Surface In BoundingBox {0.1, a, 1 - eps, 2 + eps, 1 + eps, 1 + eps};
top() -= {hanging()};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("hanging") = hanging();
Physical Surface("fault") = fault();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
Mesh.HighOrderOptimize = 1; // with order = 2: curved cells beside the surface would fold over themselves
