SetFactory("OpenCASCADE");
DefineConstant[ h = {0.4, Name "h"} ];
e = 1e-5;
s = 0.8; Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {s, s, s, 1 - s, 1 - s, 1 - s};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
f() = Surface In BoundingBox{s - e, s - e, s - e, s + e, 1 + e, 1 + e};
g() = Surface In BoundingBox{s - e, s - e, s - e, 1 + e, s + e, 1 + e};
g() += Surface In BoundingBox{s - e, s - e, s - e, 1 + e, 1 + e, s + e};
left() = Surface In BoundingBox{-e, -e, -e, e, 1 + e, 1 + e};
right() = Surface In BoundingBox{1 - e, -e, -e, 1 + e, 1 + e, 1 + e};
front() = Surface In BoundingBox{-e, -e, -e, 1 + e, e, 1 + e};
back() = Surface In BoundingBox{-e, 1 - e, -e, 1 + e, 1 + e, 1 + e};
bottom() = Surface In BoundingBox{-e, -e, -e, 1 + e, 1 + e, e};
top() = Surface In BoundingBox{-e, -e, 1 - e, 1 + e, 1 + e, 1 + e};
g() -= {f(), left(), right(), front(), back(), bottom(), top()};
Physical Volume("rock") = Volume{:};
Physical Surface("left") = left(); Physical Surface("right") = right();
Physical Surface("front") = front(); Physical Surface("back") = back();
Physical Surface("bottom") = bottom(); Physical Surface("top") = top();
Physical Surface("f") = f();
If (#g() > 0)
  Physical Surface("g") = g();
EndIf
Mesh.MeshSizeMax = h;
