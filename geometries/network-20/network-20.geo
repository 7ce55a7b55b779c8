// 20 fractures in two sets, loaded from above: made by `kluft network` from network.toml
SetFactory("OpenCASCADE");

DefineConstant[
  h = {1.2, Name "h"},  // cell size away from fractures, m
  h_fracture = {0.7, Name "h_fracture"},  // cell size on fractures, m
  h_intersection = {0.5, Name "h_intersection"},  // cell size where fractures meet, m
  growth = {0.5, Name "growth"}  // of the cell size, per metre away from them
];

low() = {0.0, 0.0, 0.0};
high() = {10.0, 10.0, 10.0};
eps = 1.7320508075688774e-5;

Box(1) = {low(0), low(1), low(2), high(0) - low(0), high(1) - low(1), high(2) - low(2)};
count = 19;

// Corners of the fractures; those of fracture i are number first(i) to first(i + 1) - 1.
// gentle-1 (set gentle), 2.349085 m2
x() += {0.8996936235463184, 0.0, 0.0, 0.9175592060783782};
y() += {1.9971045601594912, 2.725972374573422, 0.0, 0.0};
z() += {0.0, 0.40155541627888813, 0.41251887423495515, 0.0};
// gentle-3 (set gentle), 12.742989 m2
x() += {4.505360006769966, 4.190811923895053, 0.9259859591915165, 0.5587821603851397, 0.685670752453192, 1.324300670037253, 2.3035515424583184, 3.361033889263693, 4.213396169616706, 4.632248598838019};
y() += {9.539750297863758, 10.0, 10.0, 9.070561007979125, 7.918968086352176, 6.984518807065856, 6.51759809987278, 6.6433169911947, 7.327989205628572, 8.38815737623681};
z() += {6.371526505308356, 6.493930408108868, 7.8939293797196095, 8.076590063764684, 8.053400688492726, 7.804882898643266, 7.397626835311232, 6.940756431779123, 6.556689743719047, 6.348337130036398};
// gentle-4 (set gentle), 1.466281 m2
x() += {9.665086459880325, 9.215277780735995, 9.26070869542681, 9.345698827496921, 10.0, 10.0};
y() += {1.9825689619512725, 1.1344209733177166, 0.1404619146647077, 0.0, 0.0, 2.1755406775512363};
z() += {4.722885277347629, 5.074482918464514, 5.309610929147305, 5.318561234435656, 5.116392096600256, 4.571027959217474};
// gentle-5 (set gentle), 0.280926 m2
x() += {8.318517254073267, 7.352807755383168, 7.769987684423789, 7.914202944406792};
y() += {10.0, 10.0, 9.528643048185957, 9.482321297126871};
z() += {0.0, 0.1684319377140231, 0.031462852475594896, 0.0};
// gentle-6 (set gentle), 11.734638 m2
x() += {0.0, 1.1386758627568816, 2.2096734521084445, 2.960121781190555, 3.1889388262643754, 2.8348132448879007, 1.9926327006101587, 0.8880587901515726, 0.0};
y() += {4.1756939365362555, 3.980768284193263, 4.371334205400599, 5.243809808338964, 6.364415959785166, 7.432887146425848, 8.162927376664715, 8.358922960367032, 8.03507022445955};
z() += {6.900257619488174, 6.636170109101927, 6.477729323066908, 6.460562915755136, 6.589270612142742, 6.829365288922998, 7.116513771345622, 7.3737748554376505, 7.505152119173709};
// gentle-7 (set gentle), 16.610405 m2
x() += {0.0, 0.3031331604680909, 2.0999789463887257, 3.4048197923396093, 3.8680246473970588, 3.5123229691703006, 0.0};
y() += {4.963245382043773, 4.895033414404994, 5.468733554961099, 6.869115275591313, 8.720947425157467, 10.0, 10.0};
z() += {4.9089279209178525, 4.826577718587407, 4.486941796159017, 4.389676217861425, 4.560843216850815, 4.839528638941636, 5.673693501886509};
// gentle-8 (set gentle), 7.458257 m2
x() += {0.0, 0.461724312690309, 1.9595105970038476, 2.6290661292222794, 2.576133365331229, 0.0};
y() += {6.247462273697285, 6.358140319523713, 7.746669840833567, 9.690314814901146, 10.0, 10.0};
z() += {3.3543988708621253, 3.2182319493996716, 2.9573277378208154, 3.0730368416280163, 3.1452644206619946, 4.013442469245834};
// steep-01 (set steep), 3.727144 m2
x() += {9.095816447805573, 9.087306744927732, 9.57413890300727, 10.0, 10.0, 9.327429630822717};
y() += {7.541130419880698, 7.354356972118015, 7.68356765820968, 8.062056736931572, 8.522775027789036, 7.842536472672984};
z() += {9.477027512385643, 8.08948802963651, 6.818725531746903, 6.41198531409119, 10.0, 10.0};
// steep-02 (set steep), 7.502071 m2
x() += {6.28471339585986, 6.372081002497646, 5.82528204062553, 4.7162268720982174, 3.3420859336841673, 2.071059180117969, 1.898998557872793};
y() += {0.0, 0.5095590018710172, 1.1541833449703587, 1.3260294814969982, 0.9790513779462126, 0.2062215369557181, 0.0};
z() += {1.5506435671303271, 2.170262161859942, 3.404631354503244, 4.393905073294605, 4.873008224190544, 4.713565504817289, 4.556494367623376};
// steep-03 (set steep), 5.804696 m2
x() += {9.199049021760219, 9.74804957244483, 10.0, 10.0, 9.672189522316971, 9.133352291217134, 8.749059380627092, 8.622281765596451, 8.786989405691019};
y() += {5.485612425525898, 6.044658559342368, 6.3688582445647075, 7.380955566637105, 7.047146830116353, 6.353792735012102, 5.7119143484720665, 5.293502465808639, 5.210670213085073};
z() += {0.5810532288802106, 0.18295828975275774, 0.19999971595717247, 3.1887109966697857, 3.426415115537848, 3.389969236088138, 2.928748182027255, 2.1663357623230457, 1.3070197691347105};
// steep-04 (set steep), 6.121918 m2
x() += {9.507550520199642, 10.0, 10.0, 9.890830403276215, 9.743518294555345, 9.320069171433689, 9.039086364478306, 8.975858989899926, 9.147328771656364};
y() += {8.004388325111172, 8.797513920048388, 10.0, 10.0, 9.7680126781092, 8.914668806427477, 8.14915685549316, 7.676595134355479, 7.623606174567131};
z() += {0.8815635090021343, 0.4416551033755469, 3.301633129561009, 3.8173363764757102, 3.9614642054712412, 3.932201324380004, 3.43884409620631, 2.613587191819361, 1.6775575322978464};
// steep-05 (set steep), 2.509185 m2
x() += {7.624993550690441, 7.272569691727117, 6.496681173943864, 5.516015046979884, 5.3948131738043585};
y() += {0.0, 0.7195028866973314, 0.7831934163261073, 0.1519804452479363, 0.0};
z() += {4.090446371764387, 5.344970155779798, 6.666858257235212, 7.663508527354986, 7.716625047000432};
// steep-06 (set steep), 5.571144 m2
x() += {10.0, 9.851167476728927, 9.38671315504482, 9.31842891064912, 9.664611451683433, 10.0};
y() += {9.563460529871882, 9.242414329890233, 7.723893876789702, 6.681738593244447, 6.395193145868249, 6.669294916707608};
z() += {4.730711433759204, 4.7545771722498165, 4.00891816872878, 2.599351157234222, 0.9035684801736616, 0.136459381700214};
// steep-07 (set steep), 1.741996 m2
x() += {0.0, 0.1477098083772913, 0.5904744987981434, 0.5680906598419657, 0.0};
y() += {3.862761741755046, 4.1823197133513474, 5.766393575289138, 5.837835254498704, 4.805140140620734};
z() += {7.826372685443539, 7.944111772427731, 9.741364236287096, 10.0, 10.0};
// steep-08 (set steep), 0.132428 m2
x() += {2.3455502422362398, 2.070895861710494, 2.426080093377678};
y() += {10.0, 9.674204733501647, 10.0};
z() += {0.5468222961055915, 0.0, 8.326672684688674e-17};
// steep-09 (set steep), 9.448752 m2
x() += {0.4750121311691653, 0.9219644710640862, 1.5128426064379004, 2.0893212180919885, 2.496933327579822, 2.6264595993389888, 2.4431935734530073, 1.9962412335580868, 1.4053630981842722, 0.8288844865301843, 0.42127237704235104, 0.29174610528318357};
y() += {4.72536718954724, 5.1732846631288165, 5.826182226024345, 6.509116503515724, 7.039095807465602, 7.274112611375404, 7.151194352429754, 6.703276878848178, 6.050379315952648, 5.367445038461271, 4.837465734511392, 4.602448930601589};
z() += {3.6534831579728984, 2.9875011251420824, 2.725744889623318, 2.938351823337668, 3.568354070091117, 4.446943036636284, 5.338701518908499, 6.004683551739315, 6.266439787258079, 6.053832853543729, 5.42383060679028, 4.545241640245113};
// steep-10 (set steep), 17.831386 m2
x() += {1.9106119228433167, 1.8745542112678286, 2.631547246303108, 4.03615010898107, 5.7120005965607135, 7.210055924259767, 8.12891337680413, 8.185540210633894};
y() += {1.8203473115369397, 1.8007434630798196, 2.0627136540578825, 2.567267549902695, 3.179210341684663, 3.7345724525317605, 4.084545053335665, 4.115331917518134};
z() += {0.0, 0.6883439984178172, 2.2859522393129534, 3.269077405186431, 3.374291901783739, 2.5734035897095806, 1.0810098454117527, 0.0};
// steep-11 (set steep), 3.090527 m2
x() += {1.3200901600324977, 1.4664902497080419, 2.0487576815783153, 2.809165174143933, 3.5439621538533617, 4.056260363392632, 4.163530293418396};
y() += {0.44985436965314207, 0.40464339217036194, 0.5259494865855212, 0.8126784087763528, 1.1880013755951762, 1.551350901182035, 1.7299941379458295};
z() += {10.0, 9.524401054962567, 8.921626739213163, 8.68360493996868, 8.87411340611768, 9.442105548004246, 10.0};
// steep-12 (set steep), 4.322199 m2
x() += {0.8704546036541042, 1.1630015484299592, 1.15387317074506, 0.845515412028282, 0.3205524847076567, 0.0, 0.0, 0.3546200540183773};
y() += {3.9838429550171797, 4.487726263659346, 4.726399165410449, 4.63590944899109, 4.240503760839157, 3.9234355985843528, 2.998998939200035, 3.3497643651141424};
z() += {8.42890137390575, 7.7948235536533215, 6.967485228388209, 6.168571034232514, 5.612149384332017, 5.524217456161413, 8.602540921169997, 8.69981804927037};
first() = {0, 4, 14, 20, 24, 33, 40, 46, 52, 59, 68, 77, 82, 88, 93, 96, 108, 116, 123, 131};
nx() = {0.4100454897336103, 0.39398436559480426, 0.2870941765307051, 0.170292417218978, 0.19858532113445215, 0.22858848513136554, 0.3150271024499729, 0.7082231733311971, 0.38029570534970886, 0.767453139069591, 0.8776294379816003, 0.7630253494412229, 0.8859830932425091, 0.8576515478521584, 0.6726364130266311, 0.7526060440609308, -0.3434732147687857, 0.40151126271352283, -0.7162012310219859};
ny() = {0.0036681612394644067, 0.024910016179815548, 0.23291989763736323, -0.1330007603697008, -0.1517594619344851, -0.1461417964382477, -0.16417103614077178, -0.7002395226862808, -0.7399256707302165, -0.6072320128027634, -0.4418711641981224, -0.4444895034835723, -0.3923556894006339, -0.4717983334928315, -0.7333128259352466, -0.6553200928857721, 0.93912167682256, -0.8918348345108601, 0.6684048746752952};
nz() = {0.9120576960599833, 0.9187795223886854, 0.9291529772253634, 0.9763766129823056, 0.968262844450453, 0.9624914959619899, 0.934775799651681, 0.08991411248952434, 0.5548740201946802, 0.2056330760352909, 0.1857860162614407, 0.4692775270594438, 0.24716587847716484, 0.2045486616435899, 0.09905834235202021, 0.06434064270070086, 0.008753676849129638, 0.20837306415940401, 0.20072548466224954};
area() = {2.3490847435164692, 12.742988593491868, 1.4662813549793263, 0.28092622962840413, 11.734637603577537, 16.61040532942596, 7.458256921590875, 3.727143758779798, 7.502071060530046, 5.804695788211035, 6.121917520347361, 2.5091851823493667, 5.571144322907847, 1.7419955209224403, 0.1324282422396224, 9.448752403472698, 17.8313857455724, 3.090527074781061, 4.322198854165626};

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
ax() = {1.0747571557891744, 0.6138658812584092};
bx() = {0.5071010984045989, 2.5864862249845255};
ay() = {4.703182023778013, 4.9942447139998825};
by() = {4.088885200491704, 7.247302090679711};
az() = {6.7625060911797785, 4.76784368861041};
bz() = {6.782648147844887, 4.641450422679638};
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
  Error("fracture gentle-3: the pieces found have %g m2 of %g", found(1), area(1));
EndIf
Physical Surface("gentle-3") = piece_1();
If (Fabs(found(2) - area(2)) > 1e-6 * area(2))
  Error("fracture gentle-4: the pieces found have %g m2 of %g", found(2), area(2));
EndIf
Physical Surface("gentle-4") = piece_2();
If (Fabs(found(3) - area(3)) > 1e-6 * area(3))
  Error("fracture gentle-5: the pieces found have %g m2 of %g", found(3), area(3));
EndIf
Physical Surface("gentle-5") = piece_3();
If (Fabs(found(4) - area(4)) > 1e-6 * area(4))
  Error("fracture gentle-6: the pieces found have %g m2 of %g", found(4), area(4));
EndIf
Physical Surface("gentle-6") = piece_4();
If (Fabs(found(5) - area(5)) > 1e-6 * area(5))
  Error("fracture gentle-7: the pieces found have %g m2 of %g", found(5), area(5));
EndIf
Physical Surface("gentle-7") = piece_5();
If (Fabs(found(6) - area(6)) > 1e-6 * area(6))
  Error("fracture gentle-8: the pieces found have %g m2 of %g", found(6), area(6));
EndIf
Physical Surface("gentle-8") = piece_6();
If (Fabs(found(7) - area(7)) > 1e-6 * area(7))
  Error("fracture steep-01: the pieces found have %g m2 of %g", found(7), area(7));
EndIf
Physical Surface("steep-01") = piece_7();
If (Fabs(found(8) - area(8)) > 1e-6 * area(8))
  Error("fracture steep-02: the pieces found have %g m2 of %g", found(8), area(8));
EndIf
Physical Surface("steep-02") = piece_8();
If (Fabs(found(9) - area(9)) > 1e-6 * area(9))
  Error("fracture steep-03: the pieces found have %g m2 of %g", found(9), area(9));
EndIf
Physical Surface("steep-03") = piece_9();
If (Fabs(found(10) - area(10)) > 1e-6 * area(10))
  Error("fracture steep-04: the pieces found have %g m2 of %g", found(10), area(10));
EndIf
Physical Surface("steep-04") = piece_10();
If (Fabs(found(11) - area(11)) > 1e-6 * area(11))
  Error("fracture steep-05: the pieces found have %g m2 of %g", found(11), area(11));
EndIf
Physical Surface("steep-05") = piece_11();
If (Fabs(found(12) - area(12)) > 1e-6 * area(12))
  Error("fracture steep-06: the pieces found have %g m2 of %g", found(12), area(12));
EndIf
Physical Surface("steep-06") = piece_12();
If (Fabs(found(13) - area(13)) > 1e-6 * area(13))
  Error("fracture steep-07: the pieces found have %g m2 of %g", found(13), area(13));
EndIf
Physical Surface("steep-07") = piece_13();
If (Fabs(found(14) - area(14)) > 1e-6 * area(14))
  Error("fracture steep-08: the pieces found have %g m2 of %g", found(14), area(14));
EndIf
Physical Surface("steep-08") = piece_14();
If (Fabs(found(15) - area(15)) > 1e-6 * area(15))
  Error("fracture steep-09: the pieces found have %g m2 of %g", found(15), area(15));
EndIf
Physical Surface("steep-09") = piece_15();
If (Fabs(found(16) - area(16)) > 1e-6 * area(16))
  Error("fracture steep-10: the pieces found have %g m2 of %g", found(16), area(16));
EndIf
Physical Surface("steep-10") = piece_16();
If (Fabs(found(17) - area(17)) > 1e-6 * area(17))
  Error("fracture steep-11: the pieces found have %g m2 of %g", found(17), area(17));
EndIf
Physical Surface("steep-11") = piece_17();
If (Fabs(found(18) - area(18)) > 1e-6 * area(18))
  Error("fracture steep-12: the pieces found have %g m2 of %g", found(18), area(18));
EndIf
Physical Surface("steep-12") = piece_18();

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
