SetFactory("OpenCASCADE"); Box(1) = {0,0,0,1,1,1}; Box(2) = {0.2,0.2,0.2,0.6,0.6,0.6};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Mesh.MeshSizeMax = 0.3; e = 1e-5; Physical Volume("rock") = Volume{:};
f() = Surface In BoundingBox{0.2-e,0.2-e,0.2-e,0.8+e,0.8+e,0.8+e}; Physical Surface("f") = f();
b() = Surface In BoundingBox{-e,-e,1-e,1+e,1+e,1+e}; c() = Surface In BoundingBox{-e,-e,-e,1+e,1+e,e};
d() = Surface In BoundingBox{-e,-e,-e,e,1+e,1+e}; o() = Surface In BoundingBox{-e,-e,-e,1+e,e,1+e};
Physical Surface("top") = b(); Physical Surface("bottom") = c(); Physical Surface("left") = d(); Physical Surface("front") = o();
r() = Surface In BoundingBox{1-e,-e,-e,1+e,1+e,1+e}; k() = Surface In BoundingBox{-e,1-e,-e,1+e,1+e,1+e};
Physical Surface("right") = r(); Physical Surface("back") = k();
