// <<title>>
DefineConstant[
  h = {<<h>>, Name "h"},  // cell size away from fractures, m
  h_fracture = {<<h_fracture>>, Name "h_fracture"},  // cell size on fractures, m
  h_intersection = {<<h_intersection>>, Name "h_intersection"},  // cell size where fractures meet, m
//: box
  growth = {<<growth>>, Name "growth"},  // of the cell size, per metre away from them
  // How fractures are given to gmsh: 0, whole, with the lines where others meet them; 1, split along
  // closed loops of these lines; 2, as polygons that OpenCASCADE is to cut.
  form = {0, Name "form"}
//: body
  growth = {<<growth>>, Name "growth"}  // of the cell size, per metre away from them
//: always
];
//: body

// The rock: all volumes of a geometry.
SetFactory("OpenCASCADE");
Include "<<body>>";
Delete Physicals;
x() = {}; y() = {}; z() = {}; found() = {}; fractures() = {};
rock() = Volume{:};
//: always

low() = <<low>>;
high() = <<high>>;
//: fractures
count = <<count>>;
area() = <<areas>>;
names() = Str(<<names>>);
//: always

//: box
If (form == 2)
SetFactory("OpenCASCADE");
//: always
eps = <<eps>>;
//: box
Box(1) = {low(0), low(1), low(2), high(0) - low(0), high(1) - low(1), high(2) - low(2)};
//: fractures

// Corners of the fractures; those of fracture i are number first(i) to first(i + 1) - 1.
<<corners>>

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
//: fractures in box
  fractures() += s;
//: fractures in body
  // What is left of it in the rock.
  cut() = BooleanIntersection{ Surface{s}; Delete; }{ Volume{rock()}; };
  area(i) = 0;
  For k In {0 : #cut() - 1}
    m = Mass Surface{cut(k)};
    area(i) += m;
  EndFor
  fractures() += cut();
//: fractures
EndFor

// Make the mesh conform to all fractures, and to the lines and points where they meet.
//: fractures in box
BooleanFragments{ Volume{1}; Delete; }{ Surface{fractures()}; Delete; }
//: fractures in body
BooleanFragments{ Volume{rock()}; Delete; }{ Surface{fractures()}; Delete; }
//: fractures

// The pieces of fracture i are the surfaces with all corners in its plane and their centre within
// its outline.
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
    ends() = PointsOf{ Surface{near(j)}; };
    For e In {0 : #ends() - 1}
      b() = Point{ends(e)};
      far = Fabs((b(0) - x(k)) * nx(i) + (b(1) - y(k)) * ny(i) + (b(2) - z(k)) * nz(i));
      off = (far > off) ? far : off;
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
      EndIf
    EndIf
  EndFor
  If (Fabs(found(i) - area(i)) > 1e-6 * area(i))
    Error(StrCat("fracture ", names(i), ": the pieces found have %g m2 of %g"), found(i), area(i));
  EndIf
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
//: box
Else
Geometry.AutoCoherence = 0;
<<points>>
If (form == 0)
<<whole>>
Else
<<split>>
EndIf
EndIf
//: always

Physical Volume("rock") = Volume{:};
<<groups>>
//: fractures

// Points on the fractures that the cell size counts distances from: first point, step and number of
// steps of each row, <<spacing>> m apart.
SetFactory("Built-in");
Geometry.AutoCoherence = 0;
q = newp;
from = q;
<<samples>>
For k In {0 : #rows() - 1 : 7}
  For m In {0 : rows(k + 6)}
    Point(q) = {rows(k) + m * rows(k + 3), rows(k + 1) + m * rows(k + 4), rows(k + 2) + m * rows(k + 5)};
    q += 1;
  EndFor
EndFor

// The cell size grows with the distance from fractures and from where they meet.
f = newf;
Field[f] = Distance;
Field[f].PointsList = {from : q - 1};
g = newf;
Field[g] = Threshold;
Field[g].InField = f;
Field[g].SizeMin = h_fracture;
Field[g].SizeMax = h;
near = (h_fracture > 1.42 * <<spacing>>) ? h_fracture / 2 : 0.71 * <<spacing>>;
Field[g].DistMin = near;
Field[g].DistMax = near + Fabs(h - h_fracture) / growth;
fields() = {g};
//: intersections

// The same where they meet, <<line_spacing>> m apart.
from = q;
<<line_samples>>
For k In {0 : #rows() - 1 : 7}
  For m In {0 : rows(k + 6)}
    Point(q) = {rows(k) + m * rows(k + 3), rows(k + 1) + m * rows(k + 4), rows(k + 2) + m * rows(k + 5)};
    q += 1;
  EndFor
EndFor
f = newf;
Field[f] = Distance;
Field[f].PointsList = {from : q - 1};
g = newf;
Field[g] = Threshold;
Field[g].InField = f;
Field[g].SizeMin = h_intersection;
Field[g].SizeMax = h;
near = (h_intersection > <<line_spacing>>) ? h_intersection / 2 : <<line_spacing>> / 2;
Field[g].DistMin = near;
Field[g].DistMax = near + Fabs(h - h_intersection) / growth;
fields() += g;
//: fractures
f = newf;
Field[f] = Min;
Field[f].FieldsList = {fields()};
Background Field = f;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
//: always
Mesh.MeshSizeMax = h;
