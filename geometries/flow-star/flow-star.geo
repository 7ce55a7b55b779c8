// Four half planes, 1 m long and 1 m high, that meet along the line x = y = 1: each ends on one side of the block.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.2, Name "h"}   // cell size, m
];

eps = 1e-4;

Box(1) = {0, 0, 0, 2, 2, 1};

// A rectangle is born in the plane z = 0, along x and y; turned about x or y it stands upright.
west = news;
Rectangle(west) = {0, 0, 0, 1, 1};
Rotate {{1, 0, 0}, {0, 0, 0}, Pi / 2} { Surface{west}; }
Translate {0, 1, 0} { Surface{west}; }
east = news;
Rectangle(east) = {1, 0, 0, 1, 1};
Rotate {{1, 0, 0}, {0, 0, 0}, Pi / 2} { Surface{east}; }
Translate {0, 1, 0} { Surface{east}; }
south = news;
Rectangle(south) = {0, 0, 0, 1, 1};
Rotate {{0, 1, 0}, {0, 0, 0}, -Pi / 2} { Surface{south}; }
Translate {1, 0, 0} { Surface{south}; }
north = news;
Rectangle(north) = {0, 1, 0, 1, 1};
Rotate {{0, 1, 0}, {0, 0, 0}, -Pi / 2} { Surface{north}; }
Translate {1, 0, 0} { Surface{north}; }

// Make the mesh conform to the half planes and to their line.
BooleanFragments{ Volume{1}; Delete; }{ Surface{west, east, south, north}; Delete; }

// Surfaces by where they lie.
left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 2 + eps, 1 + eps};
right() = Surface In BoundingBox {2 - eps, -eps, -eps, 2 + eps, 2 + eps, 1 + eps};
front() = Surface In BoundingBox {-eps, -eps, -eps, 2 + eps, eps, 1 + eps};
back() = Surface In BoundingBox {-eps, 2 - eps, -eps, 2 + eps, 2 + eps, 1 + eps};
of_west() = Surface In BoundingBox {-eps, 1 - eps, -eps, 1 + eps, 1 + eps, 1 + eps};
of_east() = Surface In BoundingBox {1 - eps, 1 - eps, -eps, 2 + eps, 1 + eps, 1 + eps};
of_south() = Surface In BoundingBox {1 - eps, -eps, -eps, 1 + eps, 1 + eps, 1 + eps};
of_north() = Surface In BoundingBox {1 - eps, 1 - eps, -eps, 1 + eps, 2 + eps, 1 + eps};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("west") = of_west();
Physical Surface("east") = of_east();
Physical Surface("south") = of_south();
Physical Surface("north") = of_north();

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
