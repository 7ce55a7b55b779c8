// Three orthogonal joints through the centre of a cube: eight blocks, and a node with eight sectors in the middle.
// The cube has one joint per direction, so its side is the joint spacing S of the equivalent continuum.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.15, Name "h"}     // cell size, m
  side = {1, Name "side"}  // side of the cube, m
];

eps = 1e-4 * side;
mid = side / 2;

// A rectangle is born in the plane z = const; two of the three are turned upright about an edge of the cube.
Box(1) = {0, 0, 0, side, side, side};
plane_x = news;
Rectangle(plane_x) = {mid, 0, 0, side, side};
Rotate {{0, 1, 0}, {mid, 0, 0}, -Pi / 2} { Surface{plane_x}; }
plane_y = news;
Rectangle(plane_y) = {0, mid, 0, side, side};
Rotate {{1, 0, 0}, {0, mid, 0}, Pi / 2} { Surface{plane_y}; }
plane_z = news;
Rectangle(plane_z) = {0, 0, mid, side, side};

// Make the mesh conform to the joints, to the lines where they cross and to the point where they all meet.
BooleanFragments{ Volume{1}; Delete; }{ Surface{plane_x, plane_y, plane_z}; Delete; }

a = -eps;
b = side + eps;
left() = Surface In BoundingBox {-eps, a, a, eps, b, b};
right() = Surface In BoundingBox {side - eps, a, a, side + eps, b, b};
front() = Surface In BoundingBox {a, -eps, a, b, eps, b};
back() = Surface In BoundingBox {a, side - eps, a, b, side + eps, b};
bottom() = Surface In BoundingBox {a, a, -eps, b, b, eps};
top() = Surface In BoundingBox {a, a, side - eps, b, b, side + eps};
x_plane() = Surface In BoundingBox {mid - eps, a, a, mid + eps, b, b};
y_plane() = Surface In BoundingBox {a, mid - eps, a, b, mid + eps, b};
z_plane() = Surface In BoundingBox {a, a, mid - eps, b, b, mid + eps};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("x_plane") = x_plane();
Physical Surface("y_plane") = y_plane();
Physical Surface("z_plane") = z_plane();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
