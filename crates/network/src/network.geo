// <<title>>
SetFactory("OpenCASCADE");

DefineConstant[
  h = {<<h>>, Name "h"},  // cell size away from fractures, m
  h_fracture = {<<h_fracture>>, Name "h_fracture"},  // cell size on fractures, m
  h_intersection = {<<h_intersection>>, Name "h_intersection"},  // cell size where fractures meet, m
  growth = {<<growth>>, Name "growth"}  // of the cell size, per metre away from them
];

low() = <<low>>;
high() = <<high>>;
eps = <<eps>>;

Box(1) = {low(0), low(1), low(2), high(0) - low(0), high(1) - low(1), high(2) - low(2)};
count = <<count>>;

// Corners of the fractures; those of fracture i are number first(i) to first(i + 1) - 1.
<<corners>>
//: no fractures
sampling() = {};
//: fractures

For i In {0 : count - 1}
  corners() = {};
  For k In {first(i) : first(i + 1) - 1}
    p = newp;
    Point(p) = {x(k), y(k), z(k)};
    corners() += p;
  EndFor
  edges() = {};
  For k In {0 : #corners() - 1}
    c = newc;
    Line(c) = {corners(k), corners((k + 1) % #corners())};
    edges() += c;
  EndFor
  l = newll;
  Curve Loop(l) = edges();
  s = news;
  Plane Surface(s) = {l};
  fractures() += s;
EndFor

// Make the mesh conform to all fractures, and to the lines and points where they meet.
BooleanFragments{ Volume{1}; Delete; }{ Surface{fractures()}; Delete; }

// The pieces of fracture i are the surfaces with all corners in its plane and their centre within
// its outline. Long pieces are sampled more densely for the cell size below.
For level In {0 : 3}
  sampled~{level}() = {};
EndFor
For i In {0 : count - 1}
  k = first(i);
  x0 = x(k); x1 = x(k);
  y0 = y(k); y1 = y(k);
  z0 = z(k); z1 = z(k);
  For k In {first(i) : first(i + 1) - 1}
    x0 = (x(k) < x0) ? x(k) : x0; x1 = (x(k) > x1) ? x(k) : x1;
    y0 = (y(k) < y0) ? y(k) : y0; y1 = (y(k) > y1) ? y(k) : y1;
    z0 = (z(k) < z0) ? z(k) : z0; z1 = (z(k) > z1) ? z(k) : z1;
  EndFor
  near() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
  piece~{i}() = {};
  found(i) = 0;
  For j In {0 : #near() - 1}
    k = first(i);
    off = 0;
    long = 0;
    ends() = PointsOf{ Surface{near(j)}; };
    a() = Point{ends(0)};
    For e In {0 : #ends() - 1}
      b() = Point{ends(e)};
      far = Fabs((b(0) - x(k)) * nx(i) + (b(1) - y(k)) * ny(i) + (b(2) - z(k)) * nz(i));
      off = (far > off) ? far : off;
      far = Sqrt((b(0) - a(0))^2 + (b(1) - a(1))^2 + (b(2) - a(2))^2);
      long = (far > long) ? far : long;
    EndFor
    If (off < eps)
      a() = CenterOfMass Surface{near(j)};
      outside = 0;
      For k In {first(i) : first(i + 1) - 1}
        m = (k + 1 < first(i + 1)) ? k + 1 : first(i);
        ex = x(m) - x(k); ey = y(m) - y(k); ez = z(m) - z(k);
        px = a(0) - x(k); py = a(1) - y(k); pz = a(2) - z(k);
        turn = (ey * pz - ez * py) * nx(i) + (ez * px - ex * pz) * ny(i) + (ex * py - ey * px) * nz(i);
        outside += (turn < 0) ? 1 : 0;
      EndFor
      If (outside == 0)
        piece~{i}() += near(j);
        m = Mass Surface{near(j)};
        found(i) += m;
        level = (long < 4 * h_fracture) ? 0 : (long < 16 * h_fracture) ? 1 : (long < 64 * h_fracture) ? 2 : 3;
        sampled~{level}() += near(j);
      EndIf
    EndIf
  EndFor
EndFor
//: no intersections

lines() = {};
//: intersections

// Ends of the segments where fractures meet.
<<segments>>
lines() = {};
For i In {0 : #ax() - 1}
  x0 = (ax(i) < bx(i)) ? ax(i) : bx(i); x1 = ax(i) + bx(i) - x0;
  y0 = (ay(i) < by(i)) ? ay(i) : by(i); y1 = ay(i) + by(i) - y0;
  z0 = (az(i) < bz(i)) ? az(i) : bz(i); z1 = az(i) + bz(i) - z0;
  near() = Curve In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
  ex = bx(i) - ax(i); ey = by(i) - ay(i); ez = bz(i) - az(i);
  length = Sqrt(ex^2 + ey^2 + ez^2);
  For j In {0 : #near() - 1}
    ends() = PointsOf{ Curve{near(j)}; };
    off = 0;
    For e In {0 : #ends() - 1}
      b() = Point{ends(e)};
      px = b(0) - ax(i); py = b(1) - ay(i); pz = b(2) - az(i);
      off += Sqrt((ey * pz - ez * py)^2 + (ez * px - ex * pz)^2 + (ex * py - ey * px)^2) / length;
    EndFor
    If (off < eps)
      lines() += near(j);
    EndIf
  EndFor
EndFor
//: always

x0 = low(0); y0 = low(1); z0 = low(2);
x1 = high(0); y1 = high(1); z1 = high(2);
left() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x0 + eps, y1 + eps, z1 + eps};
right() = Surface In BoundingBox {x1 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
front() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y0 + eps, z1 + eps};
back() = Surface In BoundingBox {x0 - eps, y1 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
bottom() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z0 + eps};
top() = Surface In BoundingBox {x0 - eps, y0 - eps, z1 - eps, x1 + eps, y1 + eps, z1 + eps};

Physical Volume("rock") = Volume{:};
<<groups>>
//: fractures

// The cell size grows with the distance from fractures and from where they meet.
fields() = {};
For level In {0 : 3}
  If (#sampled~{level}() > 0)
    f = newf;
    Field[f] = Distance;
    Field[f].SurfacesList = {sampled~{level}()};
    Field[f].NumPointsPerCurve = 2 * 4^(level + 1);
    g = newf;
    Field[g] = Threshold;
    Field[g].InField = f;
    Field[g].SizeMin = h_fracture;
    Field[g].SizeMax = h;
    Field[g].DistMin = h_fracture / 2;
    Field[g].DistMax = h_fracture / 2 + Fabs(h - h_fracture) / growth;
    fields() += g;
  EndIf
EndFor
If (#lines() > 0)
  f = newf;
  Field[f] = Distance;
  Field[f].CurvesList = {lines()};
  Field[f].NumPointsPerCurve = 50;
  g = newf;
  Field[g] = Threshold;
  Field[g].InField = f;
  Field[g].SizeMin = h_intersection;
  Field[g].SizeMax = h;
  Field[g].DistMin = h_intersection / 2;
  Field[g].DistMax = h_intersection / 2 + Fabs(h - h_intersection) / growth;
  fields() += g;
EndIf
f = newf;
Field[f] = Min;
Field[f].FieldsList = {fields()};
Background Field = f;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
//: always
Mesh.MeshSizeMax = h;
