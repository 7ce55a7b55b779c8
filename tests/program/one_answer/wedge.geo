SetFactory("OpenCASCADE"); t = 0.5 * Tan(5 * Pi / 180); Rectangle(1) = {0,0,0,1,1};
Point(101) = {0,0.5,0}; Point(102) = {1,0.5,0}; Point(103) = {0,0.5-t,0}; Point(104) = {1,0.5+t,0};
Line(101) = {101,102}; Line(102) = {103,104}; BooleanFragments{ Surface{1}; Delete; }{ Line{101,102}; Delete; }
Rotate {{1,0,0},{0,0,0},Pi/2} { Surface{:}; }
Extrude {0,1,0} { Surface{:}; Layers{4}; }
Coherence; e = 1e-5; Mesh.MeshSizeMax = 0.4; Physical Volume("rock") = Volume{:};
f() = Surface In BoundingBox{-e,-e,0.5-e,1+e,1+e,0.5+e};
g() = Surface In BoundingBox{-e,-e,0.5-t-e,0.5+e,1+e,0.5+e}; g() += Surface In BoundingBox{0.5-e,-e,0.5-e,1+e,1+e,0.5+t+e};
b() = Surface In BoundingBox{-e,-e,1-e,1+e,1+e,1+e}; c() = Surface In BoundingBox{-e,-e,-e,1+e,1+e,e};
d() = Surface In BoundingBox{-e,-e,-e,e,1+e,1+e}; r() = Surface In BoundingBox{1-e,-e,-e,1+e,1+e,1+e};
o() = Surface In BoundingBox{-e,-e,-e,1+e,e,1+e}; k() = Surface In BoundingBox{-e,1-e,-e,1+e,1+e,1+e};
g() -= f(); g() -= d(); g() -= r(); g() -= o(); g() -= k();
Physical Surface("f") = f(); Physical Surface("g") = g(); Physical Surface("top") = b(); Physical Surface("bottom") = c();
Physical Surface("left") = d(); Physical Surface("right") = r(); Physical Surface("front") = o();
