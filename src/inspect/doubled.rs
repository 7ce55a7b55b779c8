//! Outer faces that lie on one another, as an inspection tells them.

use kluft_mesh::{DoubledSurface, Touch};

use super::findings::{DoubledFinding, Inspection};

/// Adds them; with `warn` a run that is not told what to do about them would refuse the mesh.
pub fn tell(surfaces: &[DoubledSurface], warn: bool, inspection: &mut Inspection) {
    let findings: Vec<DoubledFinding> = surfaces.iter().map(finding).collect();
    if warn {
        inspection.warnings.extend(findings.iter().map(warning));
    }
    inspection.doubled_surfaces = findings;
}

fn finding(surface: &DoubledSurface) -> DoubledFinding {
    DoubledFinding {
        volumes: surface.volumes.clone(),
        surfaces: surface.surfaces.clone(),
        kind: match surface.touch {
            Touch::Matching => "doubled nodes",
            Touch::NotMatching => "not matching",
            Touch::SameSide => "same side",
        },
        faces: surface.faces,
        area: surface.area,
        at: surface.at.to_array(),
    }
}

fn warning(finding: &DoubledFinding) -> String {
    let between = finding.between();
    match finding.kind {
        "doubled nodes" => format!(
            "{between}: nodes are doubled, so the rock does not hold together: a scene needs `weld = true` under [mesh], or a fracture with `between`"
        ),
        "not matching" => format!(
            "{between}: faces lie on one another, but their nodes do not match, so the rock does not hold together: share the faces in the geometry (BooleanFragments)"
        ),
        _ => format!(
            "{between}: cells lie on top of others: remove the copy (gmsh: Coherence; or BooleanFragments)"
        ),
    }
}
