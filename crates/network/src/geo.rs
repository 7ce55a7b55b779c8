//! Writes a network as a gmsh geometry for the OpenCASCADE kernel.
//!
//! Fragments have other numbers than what they were cut from, and gmsh's script language does not
//! say which came from where. So the script finds the pieces of each fracture again by geometry,
//! and refuses to mesh unless they make up the fracture's area.

use std::fmt::{self, Display, Write};

use glam::DVec3;

use crate::clip::FACES;
use crate::network::{Network, tolerance};

/// What gets a physical surface of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// Each fracture.
    Fracture,
    /// Each set.
    Set,
}

/// The geometry of a network, with `title` in its first line.
pub fn write_geo(network: &Network, grouping: Grouping, title: &str) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write_all(&mut out, network, grouping, title);
    out
}

fn write_all(out: &mut String, network: &Network, grouping: Grouping, title: &str) -> fmt::Result {
    head(out, network, title)?;
    corners(out, network)?;
    out.push_str(if network.fractures.is_empty() {
        NO_FRACTURES
    } else {
        DRAW_AND_FIND
    });
    segments(out, network)?;
    out.push_str(OUTER_FACES);
    groups(out, network, grouping)?;
    out.push_str(if network.fractures.is_empty() {
        ""
    } else {
        SIZES_ON_FRACTURES
    });
    out.push_str(SIZES);
    Ok(())
}

fn head(out: &mut String, network: &Network, title: &str) -> fmt::Result {
    let (sizes, domain) = (&network.sizes, &network.domain);
    let title: String = title
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    writeln!(out, "// {title}")?;
    writeln!(out, "SetFactory(\"OpenCASCADE\");\n\nDefineConstant[")?;
    for (name, value, meaning, end) in [
        ("h", sizes.h, "cell size away from fractures, m", ","),
        (
            "h_fracture",
            sizes.h_fracture,
            "cell size on fractures, m",
            ",",
        ),
        (
            "h_intersection",
            sizes.h_intersection,
            "cell size where fractures meet, m",
            ",",
        ),
        (
            "growth",
            sizes.growth,
            "of the cell size, per metre away from them",
            "",
        ),
    ] {
        writeln!(
            out,
            "  {name} = {{{value:?}, Name \"{name}\"}}{end}  // {meaning}"
        )?;
    }
    let (low, high) = (domain.low, domain.high);
    writeln!(
        out,
        "];\n\nlow() = {};\nhigh() = {};",
        List(&low.to_array()),
        List(&high.to_array())
    )?;
    writeln!(out, "eps = {:?};\n", 1e3 * tolerance(domain))?;
    writeln!(out, "{BOX}\ncount = {};", network.fractures.len())
}

const BOX: &str =
    "Box(1) = {low(0), low(1), low(2), high(0) - low(0), high(1) - low(1), high(2) - low(2)};";

/// Corners of all fractures in one list for each axis.
fn corners(out: &mut String, network: &Network) -> fmt::Result {
    writeln!(
        out,
        "\n// Corners of the fractures; those of fracture i are number first(i) to first(i + 1) - 1."
    )?;
    let mut first = vec![0];
    for fracture in &network.fractures {
        let corners = fracture.polygon.corners();
        first.push(first[first.len() - 1] + corners.len());
        let area = fracture.polygon.area();
        writeln!(
            out,
            "// {} (set {}), {area:.6} m2",
            fracture.name, fracture.set
        )?;
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let values: Vec<f64> = corners.iter().map(|corner| corner[axis]).collect();
            writeln!(out, "{name}() += {};", List(&values))?;
        }
    }
    let first: Vec<String> = first.iter().map(usize::to_string).collect();
    writeln!(out, "first() = {{{}}};", first.join(", "))?;
    let normals: Vec<DVec3> = network
        .fractures
        .iter()
        .map(|f| f.polygon.normal())
        .collect();
    for (axis, name) in ["nx", "ny", "nz"].into_iter().enumerate() {
        let values: Vec<f64> = normals.iter().map(|normal| normal[axis]).collect();
        writeln!(out, "{name}() = {};", List(&values))?;
    }
    let areas: Vec<f64> = network.fractures.iter().map(|f| f.polygon.area()).collect();
    writeln!(out, "area() = {};", List(&areas))
}

const NO_FRACTURES: &str = "sampling() = {};\n";

const DRAW_AND_FIND: &str = r#"
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
"#;

/// The segments where fractures meet, for the cell size there.
fn segments(out: &mut String, network: &Network) -> fmt::Result {
    let least = tolerance(&network.domain);
    let all = network.intersections.iter().map(|(_, shared)| shared);
    let shared: Vec<_> = all.filter(|shared| shared.length() > least).collect();
    if shared.is_empty() {
        return writeln!(out, "\nlines() = {{}};");
    }
    writeln!(out, "\n// Ends of the segments where fractures meet.")?;
    for (axis, [from, to]) in [["ax", "bx"], ["ay", "by"], ["az", "bz"]]
        .into_iter()
        .enumerate()
    {
        let starts: Vec<f64> = shared.iter().map(|shared| shared.from[axis]).collect();
        let ends: Vec<f64> = shared.iter().map(|shared| shared.to[axis]).collect();
        writeln!(
            out,
            "{from}() = {};\n{to}() = {};",
            List(&starts),
            List(&ends)
        )?;
    }
    out.push_str(FIND_LINES);
    Ok(())
}

const FIND_LINES: &str = r#"lines() = {};
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
"#;

const OUTER_FACES: &str = r#"
x0 = low(0); y0 = low(1); z0 = low(2);
x1 = high(0); y1 = high(1); z1 = high(2);
left() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x0 + eps, y1 + eps, z1 + eps};
right() = Surface In BoundingBox {x1 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
front() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y0 + eps, z1 + eps};
back() = Surface In BoundingBox {x0 - eps, y1 - eps, z0 - eps, x1 + eps, y1 + eps, z1 + eps};
bottom() = Surface In BoundingBox {x0 - eps, y0 - eps, z0 - eps, x1 + eps, y1 + eps, z0 + eps};
top() = Surface In BoundingBox {x0 - eps, y0 - eps, z1 - eps, x1 + eps, y1 + eps, z1 + eps};

Physical Volume("rock") = Volume{:};
"#;

fn groups(out: &mut String, network: &Network, grouping: Grouping) -> fmt::Result {
    for (face, ..) in FACES {
        writeln!(out, "Physical Surface(\"{face}\") = {face}();")?;
    }
    for (index, fracture) in network.fractures.iter().enumerate() {
        let name = &fracture.name;
        writeln!(
            out,
            "If (Fabs(found({index}) - area({index})) > 1e-6 * area({index}))"
        )?;
        writeln!(
            out,
            "  Error(\"fracture {name}: the pieces found have %g m2 of %g\", found({index}), area({index}));"
        )?;
        writeln!(out, "EndIf")?;
        if grouping == Grouping::Fracture {
            writeln!(out, "Physical Surface(\"{name}\") = piece_{index}();")?;
        }
    }
    if grouping == Grouping::Set {
        for set in set_names(network) {
            let members = network
                .fractures
                .iter()
                .enumerate()
                .filter(|(_, f)| f.set == set);
            let pieces: Vec<String> = members
                .map(|(index, _)| format!("piece_{index}()"))
                .collect();
            writeln!(
                out,
                "Physical Surface(\"{set}\") = {{{}}};",
                pieces.join(", ")
            )?;
        }
    }
    Ok(())
}

/// Names of the sets with fractures, in order of appearance.
pub(crate) fn set_names(network: &Network) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for fracture in &network.fractures {
        if !names.contains(&fracture.set.as_str()) {
            names.push(&fracture.set);
        }
    }
    names
}

const SIZES_ON_FRACTURES: &str = r#"
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
"#;

const SIZES: &str = "Mesh.MeshSizeMax = h;\n";

/// Numbers in braces, each with all its digits.
struct List<'a>(&'a [f64]);

impl Display for List<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = self.0.iter().map(|number| format!("{number:?}")).collect();
        write!(out, "{{{}}}", numbers.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::Domain;
    use crate::network::{Given, Sizes};
    use crate::{Orientation, Outline, Polygon};

    fn network() -> Network {
        let domain = Domain {
            low: DVec3::ZERO,
            high: DVec3::ONE,
        };
        let sizes = Sizes {
            h: 0.25,
            h_fracture: 0.125,
            h_intersection: 0.1,
            growth: 0.5,
            small: 0.2,
            small_angle: 10.0,
            mend: true,
        };
        let given = |name: &str, set: &str, dip: f64| {
            let outline = Outline::Rectangle {
                length: 0.5,
                width: 0.5,
                rotation: 0.0,
            };
            let orientation = Orientation {
                dip,
                dip_direction: 90.0,
            };
            Given {
                name: name.into(),
                set: set.into(),
                place: String::new(),
                polygon: Polygon::placed(outline, DVec3::splat(0.5), orientation),
            }
        };
        let list = vec![
            given("a", "east", 20.0),
            given("b", "east", 80.0),
            given("c", "steep", 140.0),
        ];
        Network::build(domain, sizes, list).expect("a network")
    }

    #[test]
    fn every_fracture_has_its_group_and_its_check() {
        let geo = write_geo(&network(), Grouping::Fracture, "three");
        for name in ["a", "b", "c", "top", "left"] {
            assert_eq!(
                geo.matches(&format!("Physical Surface(\"{name}\")"))
                    .count(),
                1
            );
        }
        assert!(geo.contains("Error(\"fracture c:") && geo.contains("h = {0.25, Name \"h\"},"));
    }

    #[test]
    fn sets_gather_their_fractures() {
        let geo = write_geo(&network(), Grouping::Set, "three");
        assert!(geo.contains("Physical Surface(\"east\") = {piece_0(), piece_1()};"));
        assert!(geo.contains("Physical Surface(\"steep\") = {piece_2()};"));
    }
}
