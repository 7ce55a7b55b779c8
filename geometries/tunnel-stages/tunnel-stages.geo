// A tunnel through a block of jointed rock: heading above, bench below, a ring for the lining of each.
// Two sets of joints strike along the tunnel (y), one dipping 55 degrees to the right, one 35 degrees to the left; a
// third set stands across it. No joint goes through the rings.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {1, Name "h"}              // cell size at the wall, m
  grow = {0.2, Name "grow"}      // by which it grows with each metre away from there
  radius = {5, Name "radius"}    // of the excavation, m
  lining = {0.5, Name "lining"}  // thickness of the lining, m
  floor = {-1, Name "floor"}     // height of the floor of the heading above the axis, m
  side = {40, Name "side"}       // width and height of the block, m
  length = {6, Name "length"}    // of the tunnel in it, m
];

eps = 1e-4;
half = side / 2;
mid = length / 2;

// The section in the plane y = 0, the axis of the tunnel at the origin.
Rectangle(1) = {-half, -half, 0, side, side};
Disk(2) = {0, 0, 0, radius};
Disk(3) = {0, 0, 0, radius};
Disk(4) = {0, 0, 0, radius - lining};
Disk(5) = {0, 0, 0, radius - lining};
rock() = BooleanDifference{ Surface{1}; Delete; }{ Surface{2}; Delete; };
ring() = BooleanDifference{ Surface{3}; Delete; }{ Surface{4}; Delete; };
core() = {5};

// Where the joints run: x = x0 + z / slope, from one outer face to another.
steep = -Tan(55 * Pi / 180);
flat = Tan(35 * Pi / 180);
x_steep() = {-4.2, 3.1};
x_flat() = {-6.1, 2.3};
joints() = {};
For i In {0 : 1}
  p = newp;
  Point(p) = {x_steep(i) - half / steep, -half, 0};
  Point(p + 1) = {x_steep(i) + half / steep, half, 0};
  c = newc;
  Line(c) = {p, p + 1};
  joints() += c;
  p = newp;
  Point(p) = {-half, (-half - x_flat(i)) * flat, 0};
  Point(p + 1) = {half, (half - x_flat(i)) * flat, 0};
  c = newc;
  Line(c) = {p, p + 1};
  joints() += c;
EndFor
p = newp;
Point(p) = {-half, floor, 0};
Point(p + 1) = {half, floor, 0};
level = newc;
Line(level) = {p, p + 1};

// Rings and core are cut at the floor, rock and core by the joints. Surfaces come first in what a cut returns.
all() = Surface{:};
others = #all() - #ring();
cut() = BooleanFragments{ Surface{ring()}; Delete; }{ Curve{level}; };
all() = Surface{:};
ring() = {};
For i In {0 : #all() - others - 1}
  ring() += cut(i);
EndFor
others = #all() - #core();
cut() = BooleanFragments{ Surface{core()}; Delete; }{ Curve{level, joints()}; };
all() = Surface{:};
core() = {};
For i In {0 : #all() - others - 1}
  core() += cut(i);
EndFor
others = #all() - #rock();
cut() = BooleanFragments{ Surface{rock()}; Delete; }{ Curve{joints()}; };
all() = Surface{:};
rock() = {};
For i In {0 : #all() - others - 1}
  rock() += cut(i);
EndFor
Recursive Delete { Curve{:}; }

// Upright, and drawn out along y in two halves, between which the third set stands.
section() = {rock(), ring(), core()};
Rotate {{1, 0, 0}, {0, 0, 0}, Pi / 2} { Surface{section()}; }
volumes() = {};
For i In {0 : #section() - 1}
  one() = Extrude {0, mid, 0} { Surface{section(i)}; };
  other() = Extrude {0, mid, 0} { Surface{one(0)}; };
  volumes() += {one(1), other(1)};
EndFor
Recursive Delete { Surface{section()}; }
made() = BooleanFragments{ Volume{volumes()}; Delete; }{};
Printf("%g volumes, %g made", #volumes(), #made());

heading() = {};
bench() = {};
heading_ring() = {};
bench_ring() = {};
For i In {2 * #rock() : #made() - 1}
  bb() = BoundingBox Volume{made(i)};
  is_ring = i < 2 * (#rock() + #ring());
  If (bb(2) > floor - eps)
    If (is_ring)
      heading_ring() += made(i);
    Else
      heading() += made(i);
    EndIf
  Else
    If (is_ring)
      bench_ring() += made(i);
    Else
      bench() += made(i);
    EndIf
  EndIf
EndFor
rocks() = {};
For i In {0 : 2 * #rock() - 1}
  rocks() += made(i);
EndFor

// The joints by where they lie: drawn out along y, and the corners of the box around a piece on the line of its joint.
// The arc of a wall between two crossings is wider than that, as long as it reaches an axis.
steep_joints() = {};
flat_joints() = {};
cross_joint() = {};
faces() = Surface{:};
For i In {0 : #faces() - 1}
  bb() = BoundingBox Surface{faces(i)};
  is_drawn = bb(4) - bb(1) > mid - eps;
  For j In {0 : 1}
    If (is_drawn && Abs(bb(0) - x_steep(j) - bb(5) / steep) < eps && Abs(bb(3) - x_steep(j) - bb(2) / steep) < eps)
      steep_joints() += faces(i);
    EndIf
    If (is_drawn && Abs(bb(0) - x_flat(j) - bb(2) / flat) < eps && Abs(bb(3) - x_flat(j) - bb(5) / flat) < eps)
      flat_joints() += faces(i);
    EndIf
  EndFor
  // Of the plane across, all but the pieces within the rings, which are as wide as the tunnel.
  is_across = Abs(bb(1) - mid) < eps && Abs(bb(4) - mid) < eps;
  is_ring = bb(3) - bb(0) > 1.9 * radius && bb(0) > -radius - eps && bb(3) < radius + eps;
  If (is_across && !is_ring)
    cross_joint() += faces(i);
  EndIf
EndFor

a = half + eps;
b = half - eps;
left() = Surface In BoundingBox {-a, -eps, -a, -b, length + eps, a};
right() = Surface In BoundingBox {b, -eps, -a, a, length + eps, a};
front() = Surface In BoundingBox {-a, -eps, -a, a, eps, a};
back() = Surface In BoundingBox {-a, length - eps, -a, a, length + eps, a};
bottom() = Surface In BoundingBox {-a, -eps, -a, a, length + eps, -b};
top() = Surface In BoundingBox {-a, -eps, b, a, length + eps, a};

Physical Volume("rock") = rocks();
Physical Volume("heading") = heading();
Physical Volume("bench") = bench();
Physical Volume("heading_ring") = heading_ring();
Physical Volume("bench_ring") = bench_ring();
Physical Surface("steep") = steep_joints();
Physical Surface("flat") = flat_joints();
Physical Surface("across") = cross_joint();
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();

Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * abs(sqrt(x * x + z * z) - %g)", h, grow, radius);
Background Field = 1;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
