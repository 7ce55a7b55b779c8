// A joint half way up a slab of hexahedra, cells growing away from the end where the fluid enters.
DefineConstant[
  length = {25, Name "length"}    // along the joint (m)
  first = {0.1, Name "first"}     // length of the cells at the inlet (m)
  growth = {1.05, Name "growth"}  // ratio of each length to the one before
];

Point(1) = {0, 0, 0};
Point(2) = {length, 0, 0};
Line(1) = {1, 2};
cells = Ceil(Log(1 + length * (growth - 1) / first) / Log(growth));
Transfinite Curve{1} = cells + 1 Using Progression growth;
Extrude {0, 1, 0} { Curve{1}; Layers{1}; Recombine; }
base() = Surface{:};
Extrude {0, 0, 0.5} { Surface{base()}; Layers{1}; Recombine; }
eps = 1e-4;
joint() = Surface In BoundingBox {-eps, -eps, 0.5 - eps, length + eps, 1 + eps, 0.5 + eps};
Extrude {0, 0, 0.5} { Surface{joint()}; Layers{1}; Recombine; }

Physical Volume("rock") = Volume{:};
Physical Surface("joint") = joint();
Physical Surface("inlet") = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, 1 + eps};
Physical Surface("far") = Surface In BoundingBox {length - eps, -eps, -eps, length + eps, 1 + eps, 1 + eps};
Physical Surface("front") = Surface In BoundingBox {-eps, -eps, -eps, length + eps, eps, 1 + eps};
Physical Surface("back") = Surface In BoundingBox {-eps, 1 - eps, -eps, length + eps, 1 + eps, 1 + eps};
Physical Surface("bottom") = Surface In BoundingBox {-eps, -eps, -eps, length + eps, 1 + eps, eps};
Physical Surface("top") = Surface In BoundingBox {-eps, -eps, 1 - eps, length + eps, 1 + eps, 1 + eps};
