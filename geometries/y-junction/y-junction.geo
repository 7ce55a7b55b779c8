// Three vertical joints that meet at the line x = y = 0.5 at 120 degrees: three blocks, three sectors at the line.
SetFactory("OpenCASCADE");

DefineConstant[ h = {0.15, Name "h"} ]; // cell size, m

eps = 1e-4;

Box(1) = {0, 0, 0, 1, 1, 1};

// A half plane that ends at the line and is larger than the rock, turned to three directions and cut to the rock.
joints() = {};
For i In {0:2}
  half = news;
  Rectangle(half) = {0, -2, 0, 2, 4};
  Rotate {{1, 0, 0}, {0, 0, 0}, Pi / 2} { Surface{half}; }
  Rotate {{0, 0, 1}, {0, 0, 0}, (90 + 120 * i) * Pi / 180} { Surface{half}; }
  Translate {0.5, 0.5, 0.5} { Surface{half}; }
  joints() += BooleanIntersection{ Surface{half}; Delete; }{ Volume{1}; };
EndFor

// Make the mesh conform to the joints and to the line where they meet.
BooleanFragments{ Volume{1}; Delete; }{ Surface{joints()}; Delete; }

left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, 1 + eps};
right() = Surface In BoundingBox {1 - eps, -eps, -eps, 1 + eps, 1 + eps, 1 + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, eps, 1 + eps};
back() = Surface In BoundingBox {-eps, 1 - eps, -eps, 1 + eps, 1 + eps, 1 + eps};
bottom() = Surface In BoundingBox {-eps, -eps, -eps, 1 + eps, 1 + eps, eps};
top() = Surface In BoundingBox {-eps, -eps, 1 - eps, 1 + eps, 1 + eps, 1 + eps};

// What is left are the joints: one in x = 0.5, the others to both sides of it.
inner() = Surface{:};
inner() -= {left(), right(), front(), back(), bottom(), top()};
north() = Surface In BoundingBox {0.5 - eps, -eps, -eps, 0.5 + eps, 1 + eps, 1 + eps};
east() = Surface In BoundingBox {0.5 - eps, -eps, -eps, 1 + eps, 1 + eps, 1 + eps};
east() -= {right(), front(), back(), bottom(), top(), north()};
west() = inner();
west() -= {north(), east()};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("north") = north();
Physical Surface("west") = west();
Physical Surface("east") = east();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
