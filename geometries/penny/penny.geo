// A disc-shaped crack of radius 1 in the plane z = 0, inside a large cube. Its rim is a crack front: one sector there.
// Cells are `h` at the rim, `h_disc` on the disc, and grow with the distance from either up to `h_far`.
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.08, Name "h"}            // cell size at the rim, m
  h_disc = {2 * h, Name "h_disc"} // cell size in the middle of the disc, m
  h_far = {3, Name "h_far"}       // cell size at the outer faces, m
  grow = {1.5 * h, Name "grow"}    // growth of the cell size per metre of distance
  half = {10, Name "half"}        // half the side of the cube, m
];

eps = 1e-4 * half;

Box(1) = {-half, -half, -half, 2 * half, 2 * half, 2 * half};
disc = news;
Disk(disc) = {0, 0, 0, 1};

// Embed the disc in the rock.
BooleanFragments{ Volume{1}; Delete; }{ Surface{disc}; Delete; }

a = -half - eps;
b = half + eps;
left() = Surface In BoundingBox {a, a, a, -half + eps, b, b};
right() = Surface In BoundingBox {half - eps, a, a, b, b, b};
front() = Surface In BoundingBox {a, a, a, b, -half + eps, b};
back() = Surface In BoundingBox {a, half - eps, a, b, b, b};
bottom() = Surface In BoundingBox {a, a, a, b, b, -half + eps};
top() = Surface In BoundingBox {a, a, half - eps, b, b, b};
penny() = Surface{:};
penny() -= {left(), right(), front(), back(), bottom(), top()};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
Physical Surface("penny") = penny();

// Distances in closed form (exact, and quicker than a sampled Distance field):
// to the rim sqrt((r - 1)^2 + z^2), to the disc the same with r - 1 cut at zero.
Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * sqrt((sqrt(x*x + y*y) - 1)^2 + z*z)", h, grow);
Field[2] = MathEval;
Field[2].F = Sprintf("%g + %g * sqrt((0.5 * (sqrt(x*x + y*y) - 1 + abs(sqrt(x*x + y*y) - 1)))^2 + z*z)", h_disc, grow);
Field[3] = Min;
Field[3].FieldsList = {1, 2};
Background Field = 3;
Mesh.MeshSizeMax = h_far;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
