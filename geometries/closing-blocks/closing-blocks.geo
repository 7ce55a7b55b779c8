// A jointed block, 4 x 3 x 2 m: three joints go through it (fault, bedding, cross; they meet in a point),
// two end on another (keystone on the fault, toe on the bedding), and one, lens, ends inside the rock.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.2, Name "h"}      // cell size, m
  dip = {12, Name "dip"}   // of the bedding, degrees, 0 to 15
];

lx = 4;
ly = 3;
lz = 2;
eps = 1e-4;

// One column a joint: fault, bedding, cross, keystone, toe, lens.
// Each plane passes through (px, py, pz); dipping by `dips` towards +x, then turned about z by `turns` (degrees).
dips()  = { 65, dip,  82, -40,  78,  62};
turns() = { 12,  20,  98,   5,  -6,  -8};
px()    = {1.5,   2, 2.0, 1.4, 2.8, 3.15};
py()    = {1.5, 1.5, 1.75, 1.5, 1.5,   0};
pz()    = {1.0, 0.7, 1.0, 1.3, 0.4, 1.25};
FAULT = 0;
BEDDING = 1;
KEYSTONE = 3;
TOE = 4;
LENS = 5;

Box(1) = {0, 0, 0, lx, ly, lz};

// Larger than the rock, then cut to it. The lens is a disc that pokes out of the front.
For i In {0 : 5}
  s = news;
  If (i == LENS)
    Disk(s) = {0, 0, 0, 0.6};
  Else
    Rectangle(s) = {-6, -6, 0, 12, 12};
  EndIf
  Rotate {{0, 1, 0}, {0, 0, 0}, dips(i) * Pi / 180} { Surface{s}; }
  Rotate {{0, 0, 1}, {0, 0, 0}, turns(i) * Pi / 180} { Surface{s}; }
  Translate {px(i), py(i), pz(i)} { Surface{s}; }
  cut() = BooleanIntersection{ Surface{s}; Delete; }{ Volume{1}; };

  // A joint that ends on another keeps the part on one side of it: above the fault, below the bedding.
  If (i == KEYSTONE || i == TOE)
    other = (i == KEYSTONE) ? FAULT : BEDDING;
    side = newv;
    Box(side) = {-6, -6, (i == KEYSTONE) ? 0 : -6, 12, 12, 6};
    Rotate {{0, 1, 0}, {0, 0, 0}, dips(other) * Pi / 180} { Volume{side}; }
    Rotate {{0, 0, 1}, {0, 0, 0}, turns(other) * Pi / 180} { Volume{side}; }
    Translate {px(other), py(other), pz(other)} { Volume{side}; }
    cut() = BooleanIntersection{ Surface{cut()}; Delete; }{ Volume{side}; Delete; };
  EndIf
  joints() += cut();
EndFor

// Make the mesh conform to all joints, and to the lines and points where they meet.
BooleanFragments{ Volume{1}; Delete; }{ Surface{joints()}; Delete; }

// Outer faces by where they lie.
left() = Surface In BoundingBox {-eps, -eps, -eps, eps, ly + eps, lz + eps};
right() = Surface In BoundingBox {lx - eps, -eps, -eps, lx + eps, ly + eps, lz + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, lx + eps, eps, lz + eps};
back() = Surface In BoundingBox {-eps, ly - eps, -eps, lx + eps, ly + eps, lz + eps};
bottom() = Surface In BoundingBox {-eps, -eps, -eps, lx + eps, ly + eps, eps};
top() = Surface In BoundingBox {-eps, -eps, lz - eps, lx + eps, ly + eps, lz + eps};
inner() = Surface{:};
inner() -= {left(), right(), front(), back(), bottom(), top()};

// The pieces of joint i are the inner surfaces whose corners all lie in its plane.
For i In {0 : 5}
  nx = Sin(dips(i) * Pi / 180) * Cos(turns(i) * Pi / 180);
  ny = Sin(dips(i) * Pi / 180) * Sin(turns(i) * Pi / 180);
  nz = Cos(dips(i) * Pi / 180);
  piece~{i}() = {};
  For j In {0 : #inner() - 1}
    corners() = PointsOf{ Surface{inner(j)}; };
    off = 0;
    For k In {0 : #corners() - 1}
      c() = Point{corners(k)};
      off += Fabs((c(0) - px(i)) * nx + (c(1) - py(i)) * ny + (c(2) - pz(i)) * nz);
    EndFor
    If (off < eps)
      piece~{i}() += inner(j);
    EndIf
  EndFor
EndFor

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("fault") = piece_0();
Physical Surface("bedding") = piece_1();
Physical Surface("cross") = piece_2();
Physical Surface("keystone") = piece_3();
Physical Surface("toe") = piece_4();
Physical Surface("lens") = piece_5();

Mesh.MeshSizeMin = h / 2;
Mesh.MeshSizeMax = h;
