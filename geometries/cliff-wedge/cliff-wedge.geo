// A vertical cliff with a wedge that two joints cut out of its edge. The line where they meet plunges towards the face,
// and each joint stands at the same angle to the vertical plane through it, measured around the line.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {1.5, Name "h"}            // cell size, m
  h_joint = {0.8, Name "h_joint"}  // cell size on the joints, m
  plunge = {40, Name "plunge"}   // of the line, degrees
  angle = {45, Name "angle"}     // of the joints to the vertical plane, degrees
  rise = {6, Name "rise"}        // of the wedge in the face, m
];

eps = 1e-4;
long = 10;
wide = 14;
high = 8;
low = high - rise;
tan_plunge = Tan(plunge * Pi / 180);
cos_plunge = Cos(plunge * Pi / 180);

// The face is at x = 0, and the rock behind it.
Box(1) = {-long, -wide / 2, 0, long, wide, high};
half = rise * cos_plunge * Tan(angle * Pi / 180);
p = newp;
Point(p) = {0, 0, low};
Point(p + 1) = {-rise / tan_plunge, 0, high};
Point(p + 2) = {0, -half, high};
Point(p + 3) = {0, half, high};
l = newc;
Line(l) = {p, p + 1};
Line(l + 1) = {p + 1, p + 2};
Line(l + 2) = {p + 2, p};
Line(l + 3) = {p + 1, p + 3};
Line(l + 4) = {p + 3, p};
c = newll;
Curve Loop(c) = {l, l + 1, l + 2};
Curve Loop(c + 1) = {l, l + 3, l + 4};
s = news;
Plane Surface(s) = {c};
Plane Surface(s + 1) = {c + 1};
BooleanFragments{ Volume{1}; Delete; }{ Surface{s, s + 1}; Delete; }

left_joint() = {};
right_joint() = {};
faces() = Surface{:};
For i In {0 : #faces() - 1}
  bb() = BoundingBox Surface{faces(i)};
  // The joints are the only faces that reach from the face to the back of the wedge, and no farther down than its foot.
  If (Abs(bb(0) + rise / tan_plunge) < eps && Abs(bb(2) - low) < eps)
    If (bb(1) < -eps)
      left_joint() += faces(i);
    Else
      right_joint() += faces(i);
    EndIf
  EndIf
EndFor

bottom() = Surface In BoundingBox {-long - eps, -wide, -eps, eps, wide, eps};
behind() = Surface In BoundingBox {-long - eps, -wide, -eps, -long + eps, wide, high + eps};
left() = Surface In BoundingBox {-long - eps, -wide / 2 - eps, -eps, eps, -wide / 2 + eps, high + eps};
right() = Surface In BoundingBox {-long - eps, wide / 2 - eps, -eps, eps, wide / 2 + eps, high + eps};

Physical Volume("rock") = Volume{:};
Physical Surface("left_joint") = left_joint();
Physical Surface("right_joint") = right_joint();
Physical Surface("bottom") = bottom();
Physical Surface("behind") = behind();
Physical Surface("left") = left();
Physical Surface("right") = right();

MeshSize{ PointsOf{ Volume{:}; } } = h;
MeshSize{ PointsOf{ Surface{left_joint(), right_joint()}; } } = h_joint;
