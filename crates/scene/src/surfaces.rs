//! Meshes of fractures and outer faces alone, as flow in rigid rock needs no more.

use kluft_mesh::{Defect, Draft, Mesh, SurfaceRole, outer_surfaces};

use crate::remedies::in_terms_of_scene;
use crate::roles::{Roles, roles};
use crate::scene::Scene;

/// A mesh without cells, and what was decided on the way to it.
pub struct SurfaceMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// What the scene makes of its groups.
    pub roles: Roles,
}

impl Scene {
    /// Whether a mesh serves this scene as it is, without cells: flow in rigid rock.
    pub fn takes_surfaces(&self, draft: &Draft) -> bool {
        self.is_rigid() && draft.cells.elements.is_empty() && !draft.facets.elements.is_empty()
    }
}

/// The mesh of a draft without cells. All of the outer surface counts as such, whether the scene
/// names it or not.
///
/// # Errors
/// Every defect of the mesh, and everything in the scene that does not fit it.
pub fn surface_mesh(scene: &Scene, draft: Draft) -> Result<SurfaceMesh, Vec<Defect>> {
    let defects = unfit(scene, &draft);
    if !defects.is_empty() {
        return Err(defects);
    }
    let outer = outer_surfaces(&draft);
    let groups = draft.groups.iter().zip(&outer);
    let inner: Vec<bool> = groups
        .map(|(group, outer)| group.dimension == 2 && !outer)
        .collect();
    let mut roles = roles(scene, &draft, &inner)?;
    for (role, _) in roles
        .of_group
        .iter_mut()
        .zip(&outer)
        .filter(|(_, outer)| **outer)
    {
        if *role == SurfaceRole::Unused {
            *role = SurfaceRole::Boundary;
        }
    }
    let text = "the mesh holds surfaces alone: flow in rigid rock needs no cells";
    roles.decisions.insert(0, text.to_owned());
    let draft = refined(scene, draft, &mut roles)?;
    let mesh = Mesh::of_surfaces(draft, &roles.of_group).map_err(in_terms_of_scene)?;
    Ok(SurfaceMesh { mesh, roles })
}

/// The draft with its facets divided as often as the scene wants; it is checked before, so that
/// defects name its own facets and not their parts.
fn refined(scene: &Scene, mut draft: Draft, roles: &mut Roles) -> Result<Draft, Vec<Defect>> {
    if scene.refine == 0 {
        return Ok(draft);
    }
    Mesh::of_surfaces(draft.clone(), &roles.of_group).map_err(in_terms_of_scene)?;
    let before = draft.facets.elements.len();
    draft.refine(scene.refine)?;
    let after = draft.facets.elements.len();
    roles.decisions.push(format!(
        "each facet divided into 4, {} times: {before} -> {after} facets",
        scene.refine
    ));
    Ok(draft)
}

/// What a scene asks for that needs cells.
fn unfit(scene: &Scene, draft: &Draft) -> Vec<Defect> {
    let mut defects = Vec::new();
    let mut refuse = |place: &str, what: &str| {
        let problem = format!("{what} needs cells, and the mesh holds surfaces alone");
        let remedy = "remove it, or mesh the rock as well (dimension = 3; gmsh -3)";
        defects.push(Defect::new(place, problem, remedy));
    };
    if scene.weld {
        refuse(&draft.source, "`weld` of [mesh]");
    }
    for entry in scene
        .boundaries
        .iter()
        .filter(|entry| entry.value.place.is_some())
    {
        refuse(&entry.place, "`where`");
    }
    for entry in &scene.fractures {
        if entry.value.between.is_some() {
            refuse(&entry.place, "`between`");
        }
    }
    defects
}
