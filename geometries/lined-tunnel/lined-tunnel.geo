// A quarter of a circular tunnel in a thin slice of rock: the core, a ring for the lining, the rock around it.
// The axis of the tunnel is y; one layer of cells between front and back is plane strain.
DefineConstant[
  h = {0.3, Name "h"}            // cell size at the wall, m
  radius = {3, Name "radius"}    // of the excavation, m
  lining = {0.3, Name "lining"}  // thickness of the ring, m
  far = {90, Name "far"}         // radius of the model, m
  depth = {0.3, Name "depth"}    // thickness of the slice, m
];
b = radius - lining;
h_far = h * far / radius;

Point(1) = {0, 0, 0, h};
Point(2) = {b, 0, 0, h};
Point(3) = {radius, 0, 0, h};
Point(4) = {far, 0, 0, h_far};
Point(5) = {0, 0, b, h};
Point(6) = {0, 0, radius, h};
Point(7) = {0, 0, far, h_far};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {1, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Circle(7) = {2, 1, 5};
Circle(8) = {3, 1, 6};
Circle(9) = {4, 1, 7};
Curve Loop(1) = {1, 7, -4};
Curve Loop(2) = {2, 8, -5, -7};
Curve Loop(3) = {3, 9, -6, -8};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
core() = Extrude {0, depth, 0} { Surface{1}; Layers{1}; Recombine; };
ring() = Extrude {0, depth, 0} { Surface{2}; Layers{1}; Recombine; };
rock() = Extrude {0, depth, 0} { Surface{3}; Layers{1}; Recombine; };

Physical Volume("core") = {core(1)};
Physical Volume("ring") = {ring(1)};
Physical Volume("rock") = {rock(1)};
Physical Surface("front") = {1, 2, 3};
Physical Surface("back") = {core(0), ring(0), rock(0)};
Physical Surface("bottom") = {core(2), ring(2), rock(2)};
Physical Surface("left") = {core(4), ring(4), rock(4)};
Physical Surface("far") = {rock(3)};
Physical Surface("wall") = {ring(3)};
