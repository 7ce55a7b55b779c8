//! What a scene wants joined before a mesh is checked: doubled nodes, surfaces between volumes.

use kluft_mesh::{CommonSurface, Defect, Draft, Faces, Joined, Joining};

use crate::conditions::FractureEntry;
use crate::roles::find_group;
use crate::scene::{Named, Scene};

/// A mesh as the scene wants it, not yet checked.
pub struct JoinedDraft {
    /// The mesh.
    pub draft: Draft,
    /// Its faces.
    pub faces: Faces,
    /// What was joined, one line each.
    pub decisions: Vec<String>,
}

/// Welds what the scene wants welded, and makes the surfaces of fractures between volumes; `faces`
/// are those of the draft.
///
/// # Errors
/// Volumes that the mesh has not, or that have no faces in common; surfaces that it has already;
/// whatever [`Draft::join`] objects to.
pub fn join(scene: &Scene, mut draft: Draft, faces: Faces) -> Result<JoinedDraft, Vec<Defect>> {
    let between: Vec<FractureBetween<'_>> = scene
        .fractures
        .iter()
        .filter_map(FractureBetween::of)
        .collect();
    if !scene.weld && between.is_empty() {
        return Ok(JoinedDraft {
            draft,
            faces,
            decisions: Vec::new(),
        });
    }
    let mut defects = Vec::new();
    let mut surfaces = Vec::new();
    for fracture in &between {
        match fracture.surface(&draft) {
            Ok(surface) => surfaces.push(surface),
            Err(found) => defects.extend(found),
        }
    }
    if !defects.is_empty() {
        return Err(defects);
    }
    let joining = Joining {
        weld: scene.weld,
        surfaces,
    };
    let Joined {
        faces,
        welded,
        facets,
    } = draft.join(faces, &joining)?;
    let counts = || between.iter().zip(&facets);
    let empty = counts().filter(|(_, count)| **count == 0);
    let defects: Vec<Defect> = empty.map(|(fracture, _)| fracture.nothing()).collect();
    if !defects.is_empty() {
        return Err(defects);
    }
    let mut decisions = Vec::new();
    if scene.weld || welded > 0 {
        decisions.push(format!(
            "{welded} nodes became one with another at the same place"
        ));
    }
    decisions.extend(counts().map(|(fracture, count)| fracture.decision(*count)));
    Ok(JoinedDraft {
        draft,
        faces,
        decisions,
    })
}

/// A fracture between two volumes.
struct FractureBetween<'a> {
    name: &'a str,
    place: &'a str,
    volumes: &'a [String; 2],
}

impl<'a> FractureBetween<'a> {
    /// None for a fracture on a physical surface.
    fn of(entry: &'a Named<FractureEntry>) -> Option<Self> {
        let volumes = entry.value.between.as_ref()?;
        Some(Self {
            name: &entry.name,
            place: &entry.place,
            volumes,
        })
    }

    fn surface(&self, draft: &Draft) -> Result<CommonSurface, Vec<Defect>> {
        let mut defects = Vec::new();
        let mut named = draft.groups.iter().filter(|group| group.dimension == 2);
        if named.any(|group| group.name == self.name) {
            defects.push(Defect::new(
                self.place,
                format!("the mesh has a physical surface `{}` already", self.name),
                "remove `between` to take that surface (with `weld = true` under [mesh] where its \
                 nodes are doubled), or give the fracture another name",
            ));
        }
        let [one, other] = self.volumes;
        let found = [one, other].map(|name| find_group(&draft.groups, name, 3, self.place));
        match found {
            [Ok(one), Ok(other)] if defects.is_empty() => Ok(CommonSurface {
                name: self.name.to_owned(),
                volumes: [one, other],
            }),
            found => {
                defects.extend(found.into_iter().filter_map(Result::err));
                // One name twice is wrong once.
                defects.dedup();
                Err(defects)
            }
        }
    }

    /// What is wrong if there is no such surface.
    fn nothing(&self) -> Defect {
        let [one, other] = self.volumes;
        let (problem, remedy) = match one == other {
            true => (
                format!("no faces within `{one}` lie on one another with doubled nodes"),
                "name two volumes that touch; a surface whose nodes are shared is a fracture when \
                 it is a physical surface",
            ),
            false => (
                format!(
                    "`{one}` and `{other}` have no faces in common whose nodes are shared or at the same places"
                ),
                "name two volumes that touch; where their nodes do not match, share their faces in \
                 the geometry (BooleanFragments)",
            ),
        };
        Defect::new(self.place, problem, remedy)
    }

    fn decision(&self, count: usize) -> String {
        let [one, other] = self.volumes;
        let where_to = match one == other {
            true => format!("where nodes within `{one}` were doubled"),
            false => format!("between `{one}` and `{other}`"),
        };
        format!("{}: {count} facets {where_to}", self.name)
    }
}
