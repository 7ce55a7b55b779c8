// 20 fractures in two sets, loaded from above: made by `kluft network` from network.toml
SetFactory("OpenCASCADE");

DefineConstant[
  h = {0.9, Name "h"},  // cell size away from fractures, m
  h_fracture = {0.45, Name "h_fracture"},  // cell size on fractures, m
  h_intersection = {0.35, Name "h_intersection"},  // cell size where fractures meet, m
  growth = {0.5, Name "growth"}  // of the cell size, per metre away from them
];

low() = {0.0, 0.0, 0.0};
high() = {10.0, 10.0, 10.0};
eps = 1.7320508075688774e-5;

Box(1) = {low(0), low(1), low(2), high(0) - low(0), high(1) - low(1), high(2) - low(2)};
count = 20;

// Corners of the fractures; those of fracture i are number first(i) to first(i + 1) - 1.
// gentle-1 (set gentle), 22.117551 m2
x() += {4.9399630798672645, 5.105099538518504, 10.0, 10.0, 9.476667228575161, 7.3997118723263435, 5.739162904444998};
y() += {1.301897006938102, 0.0, 0.0, 4.780570785779597, 5.003082519934321, 4.696384345448866, 3.3416564235733115};
z() += {3.096715493424603, 3.011215115877281, 1.4410479428911507, 1.5604928853247888, 1.73392510721233, 2.3924997790864655, 2.8913156804733635};
// gentle-2 (set gentle), 28.263169 m2
x() += {5.269459311650919, 4.686718357178899, 4.886029854770868, 6.152728153873082, 8.146431017897934, 10.0, 10.0};
y() += {10.0, 8.738382377482377, 6.550855108638751, 4.756926201556358, 3.838805499327922, 4.007494691521393, 10.0};
z() += {7.744607841570991, 7.7713264017149974, 7.847838395455969, 7.9381113458826995, 8.017882478091128, 8.058615034501903, 7.862641638020432};
// gentle-3 (set gentle), 10.055128 m2
x() += {6.751632880442236, 7.065234898929181, 8.61363920013111, 10.0, 10.0};
y() += {10.0, 8.386306047190061, 6.507530864929836, 5.994584699721809, 10.0};
z() += {3.936006795578078, 3.8970510637613183, 3.407400807274909, 2.9119026265701504, 2.7163244708168635};
// gentle-4 (set gentle), 56.828035 m2
x() += {7.779344678267879, 6.260011741725188, 4.277108126015426, 2.3619512536367675, 1.0277058619219952, 0.6318819260860264, 1.2805401500810192, 2.7998730866237085, 4.782776702333472, 6.69793357471213, 8.032178966426905, 8.428002902262872};
y() += {7.651804992811575, 8.824366813568373, 8.933137343807969, 7.948971607792357, 6.1355760197053035, 3.978848462932894, 2.056682344606243, 0.8841205238494452, 0.775349993609848, 1.7595157296254595, 3.5729113177125145, 5.729638874484923};
z() += {6.030518775430367, 7.210519440946606, 8.274444996958504, 8.937217449925845, 9.02124745631043, 8.504019243761531, 7.524123694134218, 6.34412302861798, 5.28019747260608, 4.61742501963874, 4.533395013254154, 5.050623225803052};
// gentle-5 (set gentle), 13.289798 m2
x() += {9.216108177912405, 8.070050258211479, 7.841553211790135, 8.566522396234463, 10.0, 10.0};
y() += {10.0, 8.420311373997857, 6.289260255502606, 4.23007941808701, 2.816834382478816, 10.0};
z() += {1.914490468088487, 2.929741879417608, 3.5055444964610296, 3.492131118760238, 2.919056271453509, 1.4422151807412138};
// gentle-6 (set gentle), 2.431868 m2
x() += {0.0, 1.1382063918259004, 1.2822010707675173, 0.0};
y() += {7.190454336440159, 8.723329403018077, 10.0, 10.0};
z() += {7.085478085644869, 6.876888489012736, 6.750003955624144, 6.824708212111647};
// gentle-7 (set gentle), 67.993530 m2
x() += {6.321144752778196, 7.212074943704752, 9.494554190719862, 1.9587734060809976, 0.8466712845266722, 0.6478998929027968, 1.7320368828653936, 3.8085886234692765};
y() += {1.3637526062536502, 1.9080643959778532, 10.0, 10.0, 8.105708622954754, 5.281580538739014, 2.8231349685779237, 1.389110417632015};
z() += {0.392974726659405, 0.0, 0.0, 4.0159794929715265, 4.323892149597711, 4.005297898680817, 3.0579837140242185, 1.7357816663851975};
// gentle-8 (set gentle), 9.268308 m2
x() += {0.0, 0.10945562726884484, 0.2974430229069338, 2.4097632171106573, 0.0};
y() += {3.71888630510559, 3.611669981749077, 3.5695521566542783, 10.0, 10.0};
z() += {0.1220980153477475, 0.07111780761155045, 0.0, 0.0, 0.8491472556314523};
// steep-01 (set steep), 18.354569 m2
x() += {2.245756358478418, 3.1370901963019837, 1.018327768440193, 0.0, 0.0, 0.7356830835131446};
y() += {9.028225486762015, 10.0, 10.0, 9.305792560817368, 7.407747457263703, 7.849541573483257};
z() += {3.6133160635880848, 4.899251026487875, 10.0, 10.0, 3.297195700483789, 3.086261123445282};
// steep-02 (set steep), 24.336253 m2
x() += {2.8725083678751, 4.798744583443306, 2.23296496758128, 0.0, 0.0, 0.8699922622322597};
y() += {8.083986673458714, 10.0, 10.0, 7.962325860747354, 6.414566830818733, 6.712417783158219};
z() += {4.519770740602115, 4.866704034993232, 10.0, 10.0, 6.606659219152757, 5.51910075996523};
// steep-03 (set steep), 3.560287 m2
x() += {5.410153660184187, 5.8488964917592305, 7.8273970228956165, 8.955708569791964, 8.864305184071148};
y() += {7.196419967511289, 7.4993379135003515, 9.040340118968663, 10.0, 10.0};
z() += {10.0, 9.487781606159839, 8.863199807396775, 9.285570433245216, 10.0};
// steep-04 (set steep), 30.579047 m2
x() += {4.939041212732784, 3.9250420258819387, 4.0688534129185765, 10.0, 10.0, 9.814550498476839, 7.1230306031411486};
y() += {7.118069106564433, 5.76379364226588, 5.501090726134574, 8.374000558192716, 10.0, 10.0, 8.682471459906978};
z() += {3.5697954480383665, 0.9924583441582284, 0.0, 4.440892098500626e-16, 4.855361340119778, 5.123593083369859, 5.082329266044602};
// steep-05 (set steep), 47.556104 m2
x() += {10.0, 9.498579163201471, 8.34920676149462, 3.9607595917156817, 3.3212446782821634, 3.4334386440019715, 3.9517993382843333, 6.34775978851063, 8.179949273749841, 9.80509877785063, 10.0};
y() += {5.16688634936022, 5.419682451176416, 5.270924490961359, 2.4920793255328753, 1.4186547872246988, 0.2613364926874208, 0.0, 0.0, 0.8756554361141389, 2.257830069971611, 2.584971392256249};
z() += {8.252575579046656, 9.119643260906438, 10.0, 10.0, 8.983683321757528, 7.116134053198193, 6.219773605897463, 3.913138132463911, 3.4805650993305015, 4.017403773564243, 4.327140667136838};
// steep-06 (set steep), 1.536262 m2
x() += {3.955041538631433, 4.3312033322417856, 4.380581740049717, 3.5535485943872556};
y() += {0.0, 0.6326139831284452, 1.1188480475967264, 0.0};
z() += {8.38094409698434, 8.749746642702538, 10.0, 10.0};
// steep-07 (set steep), 30.936785 m2
x() += {4.327577390129036, 4.040793421381419, 2.7948410639961714, 2.9375133842145025, 3.8281291037259226, 7.571341000497323};
y() += {10.0, 9.694384242373284, 7.660493013329718, 6.58949324799075, 6.69618642620275, 10.0};
z() += {8.13605673132545, 7.986873459765881, 5.3320759638849395, 1.930654986664201, 0.0, 0.0};
// steep-08 (set steep), 22.136958 m2
x() += {3.1198955469925957, 3.3950771610347275, 3.0860766180901607, 2.0422292636843395, 0.5432331534516708, 2.220446049250313e-16, 0.0, 0.3625237029873147};
y() += {2.6895570273817366, 3.099406064980299, 3.0823995225339242, 2.295382805594682, 0.9492364078962385, 0.4087720398859425, 0.0, 0.0};
z() += {0.0, 1.0843447859519841, 3.264718110581371, 5.036944332241455, 5.926156866033154, 5.844954822521881, 2.7110129185533514, 0.0};
// steep-09 (set steep), 3.550757 m2
x() += {3.7834481629541994, 4.336287626227207, 5.568193775238897, 6.802500770012465, 7.739533565083419, 7.786063088774496};
y() += {2.1414431744870517, 2.2166106722833128, 2.598414819069501, 3.0799409884569973, 3.554463459599374, 3.5952096681795207};
z() += {10.0, 9.219661255464594, 8.811998361636595, 9.018351974644283, 9.851875212530143, 10.0};
// steep-10 (set steep), 14.944849 m2
x() += {6.766738893018611, 7.036902159763126, 6.312581018861312, 5.474498926763931, 2.2439470426010466};
y() += {0.0, 1.3792349384623277, 3.142336044446189, 3.5107554354411983, 0.0};
z() += {6.2430991329703325, 7.072920635294034, 9.022233085203322, 10.0, 10.0};
// steep-11 (set steep), 8.917012 m2
x() += {8.748834177633144, 9.485285408303017, 10.0, 10.0, 7.536589402472875};
y() += {0.0, 0.8726420220630319, 1.7395826696166399, 2.8333704654749523, 0.0};
z() += {6.862775371319178, 6.920351651346921, 7.538942214803478, 10.0, 10.0};
// steep-12 (set steep), 0.602065 m2
x() += {10.0, 10.0, 9.81015817083598, 8.494071793117529};
y() += {4.632739591487647, 4.6368305526384805, 4.406493770863505, 2.7972584426864264};
z() += {0.0, 0.36681700598601397, 0.4609189035227317, 0.0};
first() = {0, 7, 14, 19, 31, 37, 41, 49, 54, 60, 66, 71, 78, 89, 93, 99, 107, 113, 118, 123, 127};
nx() = {0.30535962299654984, -0.024930355806374975, 0.35114700806025195, 0.4409932110683076, 0.5082329537135232, 0.05791578766370315, 0.4662208084991489, 0.33038463280203184, 0.5484648583754658, 0.6387857960806467, 0.628159014933421, 0.4173847187153988, 0.46763035642294937, 0.7886285701554906, 0.6398388042387879, 0.6952251119130002, 0.33754178658958245, 0.5508133809996524, 0.7244827506086189, 0.7730762530148841};
ny() = {-0.023784695423025477, 0.03267544984305967, 0.04566465092394972, -0.2850341657915397, 0.17343694760019704, 0.0922633195420132, -0.13150615279204353, -0.10852714285591844, -0.8045390524119973, -0.7000070702962136, -0.7739234812389273, -0.8616942732711135, -0.7384978262473918, -0.5829406133710027, -0.7249356449885447, -0.7127546020842349, -0.9293444297646013, -0.5068513710317545, -0.6298853282059983, -0.6342736542113097};
nz() = {0.9519400132923497, 0.9991550391890747, 0.9352061368416736, 0.8510467155939115, 0.8435750648085529, 0.9940489129848598, 0.874839579294533, 0.9375861846634674, 0.2278227650415686, 0.3192848387583199, 0.08036601983981867, 0.28857057368109285, 0.4857394470079843, 0.1955638504866013, 0.25509726618550993, 0.09296731131586133, 0.14961441498539063, 0.663103541684828, 0.2799450256414492, 0.007073796568946744};
area() = {22.117550580174047, 28.263168698839767, 10.055128431557476, 56.82803504791395, 13.289797535089129, 2.4318678767730906, 67.99352986970985, 9.26830818104765, 18.35456948977801, 24.3362532310531, 3.5602866842790055, 30.579046546111933, 47.55610388519841, 1.5362624581621023, 30.93678525222486, 22.13695784370377, 3.5507571632803616, 14.944849487039093, 8.917012122738202, 0.6020650425996031};

For i In {0 : count - 1}
  corners() = {};
  For k In {first(i) : first(i + 1) - 1}
    p = newp;
    Point(p) = {x(k), y(k), z(k)};
    corners() += p;
  EndFor
  edges() = {};
  For k In {0 : #corners() - 1}
    c = newc;
    Line(c) = {corners(k), corners((k + 1) % #corners())};
    edges() += c;
  EndFor
  l = newll;
  Curve Loop(l) = edges();
  s = news;
  Plane Surface(s) = {l};
  fractures() += s;
EndFor

// Make the mesh conform to all fractures, and to the lines and points where they meet.
BooleanFragments{ Volume{1}; Delete; }{ Surface{fractures()}; Delete; }

// The pieces of fracture i are the surfaces with all corners in its plane and their centre within
// its outline. Long pieces are sampled more densely for the cell size below.
For level In {0 : 3}
  sampled~{level}() = {};
EndFor
For i In {0 : count - 1}
  k = first(i);
  x0 = x(k); x1 = x(k);
  y0 = y(k); y1 = y(k);
  z0 = z(k); z1 = z(k);
  For k In {first(i) : first(i + 1) - 1}
    x0 = (x(k) < x0) ? x(k) : x0; x1 = (x(k) > x1) ? x(k) : x1;
    y0 = (y(k) < y0) ? y(k) : y0; y1 = (y(k) > y1) ? y(k) : y1;
    z0 = (z(k) < z0) ? z(k) : z0; z1 = (z(k) > z1) ? z(k) : z1;
  EndFor
  near() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
  piece~{i}() = {};
  found(i) = 0;
  For j In {0 : #near() - 1}
    k = first(i);
    off = 0;
    long = 0;
    ends() = PointsOf{ Surface{near(j)}; };
    a() = Point{ends(0)};
    For e In {0 : #ends() - 1}
      b() = Point{ends(e)};
      far = Fabs((b(0) - x(k)) * nx(i) + (b(1) - y(k)) * ny(i) + (b(2) - z(k)) * nz(i));
      off = (far > off) ? far : off;
      far = Sqrt((b(0) - a(0))^2 + (b(1) - a(1))^2 + (b(2) - a(2))^2);
      long = (far > long) ? far : long;
    EndFor
    If (off < eps)
      a() = CenterOfMass Surface{near(j)};
      outside = 0;
      For k In {first(i) : first(i + 1) - 1}
        m = (k + 1 < first(i + 1)) ? k + 1 : first(i);
        ex = x(m) - x(k); ey = y(m) - y(k); ez = z(m) - z(k);
        px = a(0) - x(k); py = a(1) - y(k); pz = a(2) - z(k);
        turn = (ey * pz - ez * py) * nx(i) + (ez * px - ex * pz) * ny(i) + (ex * py - ey * px) * nz(i);
        outside += (turn < 0) ? 1 : 0;
      EndFor
      If (outside == 0)
        piece~{i}() += near(j);
        m = Mass Surface{near(j)};
        found(i) += m;
        level = (long < 4 * h_fracture) ? 0 : (long < 16 * h_fracture) ? 1 : (long < 64 * h_fracture) ? 2 : 3;
        sampled~{level}() += near(j);
      EndIf
    EndIf
  EndFor
EndFor

// Ends of the segments where fractures meet.
ax() = {4.736006635796093, 8.146431017897932, 7.14612520191991, 8.070050258211479, -3.3306690738754696e-16, 1.00117326807431, 4.39091110573103, 2.8901242867251753, 2.4196452331693608, 5.671417076739388, 4.3312033322417856, 6.158223970949756};
bx() = {5.19973015581868, 10.0, 10.0, 10.0, 1.1944100446255341, 2.3029645638703404, 8.883345571173944, 7.052470466225348, 3.222239806599325, 5.341871924992134, 3.893291673699795, 4.430846047280743};
ay() = {8.197422850249257, 3.8388054993279233, 8.2881568147018, 8.420311373997857, 8.447444959309781, 8.368878496924262, 6.385998346763118, 6.945229470777527, 2.348286576173046, 3.4241905683787586, 0.6326139831284452, 2.8285965981298435};
by() = {8.882527678972338, 5.017583635548408, 9.295188554106392, 8.930609953212791, 9.221636364773005, 9.090596591267257, 7.8331190540037845, 10.0, 3.089893571000468, 3.3666249636047243, 1.6653345369377348e-16, 2.3765807957081186};
az() = {7.7902472593204255, 8.017882478091128, 3.8714712086963794, 2.929741879417608, 6.968809654158037, 4.28111449879917, 2.1765832237595193, 3.0604485587115775, 2.620163094885106, 9.770261107134361, 8.749746642702538, 8.910640646889874};
bz() = {7.779412788498942, 8.025582012265065, 2.750739309830462, 1.6620791303126692, 6.827363226602815, 3.695850831546469, 1.3322676295501878e-15, 1.3014388870866669, 2.303921792255403, 10.000000000000002, 8.629955903446335, 10.0};
lines() = {};
For i In {0 : #ax() - 1}
  x0 = (ax(i) < bx(i)) ? ax(i) : bx(i); x1 = ax(i) + bx(i) - x0;
  y0 = (ay(i) < by(i)) ? ay(i) : by(i); y1 = ay(i) + by(i) - y0;
  z0 = (az(i) < bz(i)) ? az(i) : bz(i); z1 = az(i) + bz(i) - z0;
  near() = Curve In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
  ex = bx(i) - ax(i); ey = by(i) - ay(i); ez = bz(i) - az(i);
  length = Sqrt(ex^2 + ey^2 + ez^2);
  For j In {0 : #near() - 1}
    ends() = PointsOf{ Curve{near(j)}; };
    off = 0;
    For e In {0 : #ends() - 1}
      b() = Point{ends(e)};
      px = b(0) - ax(i); py = b(1) - ay(i); pz = b(2) - az(i);
      off += Sqrt((ey * pz - ez * py)^2 + (ez * px - ex * pz)^2 + (ex * py - ey * px)^2) / length;
    EndFor
    If (off < eps)
      lines() += near(j);
    EndIf
  EndFor
EndFor

x0 = low(0); y0 = low(1); z0 = low(2);
x1 = high(0); y1 = high(1); z1 = high(2);
left() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x0 + eps, y1 + eps, z1 + eps};
right() = Surface In BoundingBox {x1 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
front() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y0 + eps, z1 + eps};
back() = Surface In BoundingBox {x0 - eps, y1 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
bottom() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z0 + eps};
top() = Surface In BoundingBox {x0 - eps, y0 - eps, z1 - eps, x1 + eps, y1 + eps, z1 + eps};

Physical Volume("rock") = Volume{:};
Physical Surface("left") = left();
Physical Surface("right") = right();
Physical Surface("front") = front();
Physical Surface("back") = back();
Physical Surface("bottom") = bottom();
Physical Surface("top") = top();
If (Fabs(found(0) - area(0)) > 1e-6 * area(0))
  Error("fracture gentle-1: the pieces found have %g m2 of %g", found(0), area(0));
EndIf
Physical Surface("gentle-1") = piece_0();
If (Fabs(found(1) - area(1)) > 1e-6 * area(1))
  Error("fracture gentle-2: the pieces found have %g m2 of %g", found(1), area(1));
EndIf
Physical Surface("gentle-2") = piece_1();
If (Fabs(found(2) - area(2)) > 1e-6 * area(2))
  Error("fracture gentle-3: the pieces found have %g m2 of %g", found(2), area(2));
EndIf
Physical Surface("gentle-3") = piece_2();
If (Fabs(found(3) - area(3)) > 1e-6 * area(3))
  Error("fracture gentle-4: the pieces found have %g m2 of %g", found(3), area(3));
EndIf
Physical Surface("gentle-4") = piece_3();
If (Fabs(found(4) - area(4)) > 1e-6 * area(4))
  Error("fracture gentle-5: the pieces found have %g m2 of %g", found(4), area(4));
EndIf
Physical Surface("gentle-5") = piece_4();
If (Fabs(found(5) - area(5)) > 1e-6 * area(5))
  Error("fracture gentle-6: the pieces found have %g m2 of %g", found(5), area(5));
EndIf
Physical Surface("gentle-6") = piece_5();
If (Fabs(found(6) - area(6)) > 1e-6 * area(6))
  Error("fracture gentle-7: the pieces found have %g m2 of %g", found(6), area(6));
EndIf
Physical Surface("gentle-7") = piece_6();
If (Fabs(found(7) - area(7)) > 1e-6 * area(7))
  Error("fracture gentle-8: the pieces found have %g m2 of %g", found(7), area(7));
EndIf
Physical Surface("gentle-8") = piece_7();
If (Fabs(found(8) - area(8)) > 1e-6 * area(8))
  Error("fracture steep-01: the pieces found have %g m2 of %g", found(8), area(8));
EndIf
Physical Surface("steep-01") = piece_8();
If (Fabs(found(9) - area(9)) > 1e-6 * area(9))
  Error("fracture steep-02: the pieces found have %g m2 of %g", found(9), area(9));
EndIf
Physical Surface("steep-02") = piece_9();
If (Fabs(found(10) - area(10)) > 1e-6 * area(10))
  Error("fracture steep-03: the pieces found have %g m2 of %g", found(10), area(10));
EndIf
Physical Surface("steep-03") = piece_10();
If (Fabs(found(11) - area(11)) > 1e-6 * area(11))
  Error("fracture steep-04: the pieces found have %g m2 of %g", found(11), area(11));
EndIf
Physical Surface("steep-04") = piece_11();
If (Fabs(found(12) - area(12)) > 1e-6 * area(12))
  Error("fracture steep-05: the pieces found have %g m2 of %g", found(12), area(12));
EndIf
Physical Surface("steep-05") = piece_12();
If (Fabs(found(13) - area(13)) > 1e-6 * area(13))
  Error("fracture steep-06: the pieces found have %g m2 of %g", found(13), area(13));
EndIf
Physical Surface("steep-06") = piece_13();
If (Fabs(found(14) - area(14)) > 1e-6 * area(14))
  Error("fracture steep-07: the pieces found have %g m2 of %g", found(14), area(14));
EndIf
Physical Surface("steep-07") = piece_14();
If (Fabs(found(15) - area(15)) > 1e-6 * area(15))
  Error("fracture steep-08: the pieces found have %g m2 of %g", found(15), area(15));
EndIf
Physical Surface("steep-08") = piece_15();
If (Fabs(found(16) - area(16)) > 1e-6 * area(16))
  Error("fracture steep-09: the pieces found have %g m2 of %g", found(16), area(16));
EndIf
Physical Surface("steep-09") = piece_16();
If (Fabs(found(17) - area(17)) > 1e-6 * area(17))
  Error("fracture steep-10: the pieces found have %g m2 of %g", found(17), area(17));
EndIf
Physical Surface("steep-10") = piece_17();
If (Fabs(found(18) - area(18)) > 1e-6 * area(18))
  Error("fracture steep-11: the pieces found have %g m2 of %g", found(18), area(18));
EndIf
Physical Surface("steep-11") = piece_18();
If (Fabs(found(19) - area(19)) > 1e-6 * area(19))
  Error("fracture steep-12: the pieces found have %g m2 of %g", found(19), area(19));
EndIf
Physical Surface("steep-12") = piece_19();

// The cell size grows with the distance from fractures and from where they meet.
fields() = {};
For level In {0 : 3}
  If (#sampled~{level}() > 0)
    f = newf;
    Field[f] = Distance;
    Field[f].SurfacesList = {sampled~{level}()};
    Field[f].NumPointsPerCurve = 2 * 4^(level + 1);
    g = newf;
    Field[g] = Threshold;
    Field[g].InField = f;
    Field[g].SizeMin = h_fracture;
    Field[g].SizeMax = h;
    Field[g].DistMin = h_fracture / 2;
    Field[g].DistMax = h_fracture / 2 + Fabs(h - h_fracture) / growth;
    fields() += g;
  EndIf
EndFor
If (#lines() > 0)
  f = newf;
  Field[f] = Distance;
  Field[f].CurvesList = {lines()};
  Field[f].NumPointsPerCurve = 50;
  g = newf;
  Field[g] = Threshold;
  Field[g].InField = f;
  Field[g].SizeMin = h_intersection;
  Field[g].SizeMax = h;
  Field[g].DistMin = h_intersection / 2;
  Field[g].DistMax = h_intersection / 2 + Fabs(h - h_intersection) / growth;
  fields() += g;
EndIf
f = newf;
Field[f] = Min;
Field[f].FieldsList = {fields()};
Background Field = f;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeMax = h;
