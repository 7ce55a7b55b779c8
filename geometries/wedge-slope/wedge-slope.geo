// A slope with a wedge that two joints of different attitude cut out of it, in the attitudes of an example of Hoek and
// Bray. x points east, y north, z up; the foot of the wedge is the origin. Planes have a dip and a dip direction.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {25, Name "h"}             // cell size, m
  h_joint = {5, Name "h_joint"}  // cell size on the joints, m
];

west = -75;
east = 55;
south = -40;
north = 110;
low = -20;
height = 40;  // of the line where the joints meet, m

// Upward normals of the left joint, the right joint, the face and the ground.
dip() = {45, 70, 65, 12};
direction() = {105, 235, 185, 195};
For i In {0 : 3}
  dip(i) *= Pi / 180;
  nx(i) = Sin(dip(i)) * Sin(direction(i) * Pi / 180);
  ny(i) = Sin(dip(i)) * Cos(direction(i) * Pi / 180);
  nz(i) = Cos(dip(i));
EndFor
face = 2;
ground = 3;

// The direction in which two planes meet: `rx`, `ry`, `rz`.
Macro Ray
  rx = ny(first) * nz(second) - nz(first) * ny(second);
  ry = nz(first) * nx(second) - nx(first) * nz(second);
  rz = nx(first) * ny(second) - ny(first) * nx(second);
Return

// Corners of the wedge: its foot, the upper end of the line, and the ends of the joints on the crest, where their traces on
// the face reach the ground.
first = 0;
second = 1;
Call Ray;
tx = rx * height / rz;
ty = ry * height / rz;
level = nx(ground) * tx + ny(ground) * ty + nz(ground) * height;
Point(1) = {0, 0, 0};
Point(2) = {tx, ty, height};
For i In {0 : 1}
  first = i;
  second = face;
  Call Ray;
  reach = level / (nx(ground) * rx + ny(ground) * ry + nz(ground) * rz);
  Point(3 + i) = {reach * rx, reach * ry, reach * rz};
EndFor
Line(1) = {1, 2};
For i In {0 : 1}
  Line(2 + 2 * i) = {2, 3 + i};
  Line(3 + 2 * i) = {3 + i, 1};
  Curve Loop(1 + i) = {1, 2 + 2 * i, 3 + 2 * i};
  Plane Surface(1 + i) = {1 + i};
EndFor

// What lies above the face and above the ground is cut off.
far = 400;
Box(1) = {west, south, low, east - west, north - south, far};
Box(2) = {-far, -far, 0, 2 * far, 2 * far, far};
Rotate{ {-ny(face), nx(face), 0}, {0, 0, 0}, dip(face) }{ Volume{2}; }
Box(3) = {-far, -far, 0, 2 * far, 2 * far, far};
Rotate{ {-ny(ground), nx(ground), 0}, {0, 0, 0}, dip(ground) }{ Volume{3}; }
Translate{ tx, ty, height }{ Volume{3}; }
BooleanDifference(10) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
BooleanFragments{ Volume{10}; Delete; }{ Surface{1, 2}; Delete; }

eps = 1e-3;
wide = 2 * far;
bottom() = Surface In BoundingBox {-wide, -wide, low - eps, wide, wide, low + eps};
left_side() = Surface In BoundingBox {west - eps, -wide, -wide, west + eps, wide, wide};
right_side() = Surface In BoundingBox {east - eps, -wide, -wide, east + eps, wide, wide};
behind() = Surface In BoundingBox {-wide, north - eps, -wide, wide, north + eps, wide};

Physical Volume("rock") = Volume{:};
Physical Surface("left_joint") = {1};
Physical Surface("right_joint") = {2};
Physical Surface("bottom") = bottom();
Physical Surface("west") = left_side();
Physical Surface("east") = right_side();
Physical Surface("north") = behind();

MeshSize{ PointsOf{ Volume{:}; } } = h;
MeshSize{ PointsOf{ Surface{1, 2}; } } = h_joint;
