// A box and a rectangle in it that do not know of each other.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Rectangle(7) = {0.2, 0.2, 0.5, 0.6, 0.6};
Physical Volume("rock") = {1};
Physical Surface("joint") = {7};
Physical Surface("top") = {6};
Physical Surface("bottom") = {5};
Mesh.MeshSizeMax = 0.2;
