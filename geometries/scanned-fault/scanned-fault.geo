// A block that a fault cuts through, from side to side; it dips to the right. The fault is drawn in six fields, two along x
// and three along y, which can be groups of their own.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {1.2, Name "h"}              // cell size, m
  h_fault = {0.6, Name "h_fault"}  // cell size on the fault, m
  dip = {30, Name "dip"}           // degrees
  fields = {0, Name "fields"}      // 1: six groups, `fault-1` to `fault-6`, along y first
];

eps = 1e-4;
long = 12;
wide = 9;
high = 12;

rise = long / 2 * Tan(dip * Pi / 180);
Box(1) = {0, 0, 0, long, wide, high};
p = newp;
For i In {0 : 2}
  For j In {0 : 3}
    Point(p + 4 * i + j) = {i * long / 2, j * wide / 3, high / 2 + (1 - i) * rise};
  EndFor
EndFor
part() = {};
For i In {0 : 1}
  For j In {0 : 2}
    a = p + 4 * i + j;
    l = newl;
    Line(l) = {a, a + 4};
    Line(l + 1) = {a + 4, a + 5};
    Line(l + 2) = {a + 5, a + 1};
    Line(l + 3) = {a + 1, a};
    c = newll;
    Curve Loop(c) = {l, l + 1, l + 2, l + 3};
    s = news;
    Plane Surface(s) = {c};
    part() += s;
  EndFor
EndFor
BooleanFragments{ Volume{1}; Delete; }{ Surface{part()}; Delete; }

Physical Volume("rock") = Volume{:};
all() = {};
For i In {0 : 1}
  For j In {0 : 2}
    x = i * long / 2;
    y = j * wide / 3;
    z = high / 2 - i * rise;
    one() = Surface In BoundingBox {x - eps, y - eps, z - eps, x + long / 2 + eps, y + wide / 3 + eps, z + rise + eps};
    all() += one();
    If (fields == 1)
      Physical Surface(Sprintf("fault-%g", 3 * i + j + 1)) = one();
    EndIf
  EndFor
EndFor
If (fields == 0)
  Physical Surface("fault") = all();
EndIf
bottom() = Surface In BoundingBox {-eps, -eps, -eps, long + eps, wide + eps, eps};
top() = Surface In BoundingBox {-eps, -eps, high - eps, long + eps, wide + eps, high + eps};
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();

MeshSize{ PointsOf{ Volume{:}; } } = h;
MeshSize{ PointsOf{ Surface{all()}; } } = h_fault;
