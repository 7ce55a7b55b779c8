SetFactory("OpenCASCADE"); Box(1) = {0,0,0,1,1,1}; Box(2)={0,0,1,1,1,1}; BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Mesh.MeshSizeMax = 0.3; e=1e-5; Physical Volume("low")={1}; Physical Volume("high")={2};
f()=Surface In BoundingBox{-e,-e,0.999,1+e,1+e,1.001}; Physical Surface("f")=f();
b() = Surface In BoundingBox{-e,-e,2-e,1+e,1+e,2+e}; c() = Surface In BoundingBox{-e,-e,-e,1+e,1+e,e};
d() = Surface In BoundingBox{-e,-e,-e,e,1+e,2+e}; o() = Surface In BoundingBox{-e,-e,-e,1+e,e,2+e};
Physical Surface("top") = b(); Physical Surface("bottom") = c(); Physical Surface("left") = d(); Physical Surface("front") = o();
