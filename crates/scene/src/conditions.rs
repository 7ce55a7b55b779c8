//! Conditions of a scene: what acts on faces, nodes and the whole rock.

use glam::DVec3;
use kluft_solver::{
    Conduit, Field, Fracture, LawParameter, LoadField, SpringStiffness, Support, SurfaceLoad,
};

use crate::conduit::HydraulicParameter;
use crate::drive::DriveEntry;
use crate::field::{self, FieldEntry, InTime, Value, read_value};
use crate::fluid::{LeakoffEntry, read_boundary_fluid};
use crate::history::LoadHistory;
use crate::load::{Clock, Scaled, read_history};
use crate::place::SurfacePlace;
use crate::reader::Section;
use crate::setting::Setting;

/// What acts on a part of the outer surface.
#[derive(Debug, Clone)]
pub struct BoundaryEntry {
    /// Where its faces lie; none if it is a physical surface of the mesh.
    pub place: Option<SurfacePlace>,
    /// Its load.
    pub load: Option<LoadEntry>,
    /// Its support; displacements that vary are 0 in it.
    pub support: Option<Support>,
    /// Components of its displacement that vary, by axis.
    pub displacement_fields: Vec<(usize, FieldEntry)>,
    /// Its springs.
    pub springs: Option<SpringEntry>,
    /// What drives the fluid there.
    pub fluid: Option<DriveEntry>,
    /// How all change with time.
    pub history: Option<LoadHistory>,
}

/// Springs on a part of the outer surface.
#[derive(Debug, Clone)]
pub struct SpringEntry {
    /// How stiff they are.
    pub stiffness: SpringStiffness,
    /// What is asked of values that vary.
    pub fields: Vec<FieldEntry>,
}

/// A load on a part of the outer surface.
#[derive(Debug, Clone)]
pub enum LoadEntry {
    /// The same all over it.
    Uniform(SurfaceLoad),
    /// One that varies.
    Varying(Box<VaryingLoadEntry>),
}

/// A load that varies within its surface.
#[derive(Debug, Clone)]
pub struct VaryingLoadEntry {
    /// Its values.
    pub load: LoadField,
    /// What is asked of them.
    pub fields: Vec<FieldEntry>,
}

impl BoundaryEntry {
    /// The load, if it is the same all over the surface.
    pub(crate) fn uniform_load(&self) -> Option<SurfaceLoad> {
        match self.load {
            Some(LoadEntry::Uniform(load)) => Some(load),
            Some(LoadEntry::Varying(_)) | None => None,
        }
    }

    /// The load, if it varies.
    pub(crate) fn varying_load(&self) -> Option<&VaryingLoadEntry> {
        match &self.load {
            Some(LoadEntry::Varying(load)) => Some(load),
            Some(LoadEntry::Uniform(_)) | None => None,
        }
    }

    /// All of its values that vary.
    pub(crate) fn fields(&self) -> impl Iterator<Item = &FieldEntry> {
        let load = self.varying_load().map_or(&[][..], |load| &load.fields);
        let displacement = self.displacement_fields.iter().map(|(_, field)| field);
        load.iter()
            .chain(displacement)
            .chain(self.spring_fields())
            .chain(self.fluid.iter().filter_map(|own| own.field.as_deref()))
    }

    /// Whether it prescribes displacements that grow with its load case: other than 0, and without
    /// the time in them.
    pub(crate) fn moves(&self) -> bool {
        let plain = matches!(self.support, Some(Support::Displacement(own)) if is_moved(&own));
        plain || grows(&self.displacement_fields)
    }

    /// Values of its springs that vary.
    pub(crate) fn spring_fields(&self) -> &[FieldEntry] {
        self.springs.as_ref().map_or(&[], |springs| &springs.fields)
    }
}

/// A fracture, where it is if not on a physical surface, and the history of its fluid pressure.
#[derive(Debug, Clone)]
pub struct FractureEntry {
    /// The physical volumes that it lies between; none if it is a physical surface of the mesh.
    pub between: Option<[String; 2]>,
    /// Its law and what fills it. Parameters that vary are not numbers until the mesh is known.
    pub fracture: Fracture,
    /// Parameters of the law that vary.
    pub fields: Vec<(LawParameter, FieldEntry)>,
    /// The fluid pressure, if it varies.
    pub varying_pressure: Option<Box<FieldEntry>>,
    /// How it conducts; none if nothing flows in the scene. Parameters that vary are not numbers.
    pub conduit: Option<Conduit>,
    /// Parameters of its hydraulic aperture that vary.
    pub hydraulic_fields: Vec<(HydraulicParameter, FieldEntry)>,
    /// What leaks off from it into the rock; none if nothing does.
    pub leakoff: Option<LeakoffEntry>,
    /// The fluid pressure all over it, where it is given and the fracture conducts.
    pub given_pressure: Option<DriveEntry>,
    /// How the fluid pressure changes with time.
    pub history: Option<LoadHistory>,
}

impl FractureEntry {
    /// All of its values that vary.
    pub(crate) fn varying(&self) -> impl Iterator<Item = &FieldEntry> {
        let law = self.fields.iter().map(|(_, field)| field);
        let hydraulic = self.hydraulic_fields.iter().map(|(_, field)| field);
        let leakoff = self.leakoff.iter();
        let given = self.given_pressure.iter();
        law.chain(hydraulic)
            .chain(leakoff.filter_map(|own| own.field.as_deref()))
            .chain(self.varying_pressure.as_deref())
            .chain(given.filter_map(|own| own.field.as_deref()))
    }
}

/// What acts in all of the rock.
#[derive(Debug, Clone, Default)]
pub struct BodyEntry {
    /// Acceleration of gravity (m/s^2).
    pub gravity: DVec3,
    /// How it changes with time.
    pub history: Option<LoadHistory>,
}

/// A node held by itself.
#[derive(Debug, Clone)]
pub struct FixedPointEntry {
    /// Where the node is (m).
    pub at: DVec3,
    /// Prescribed components (m); 0 for those that vary.
    pub displacement: [Option<f64>; 3],
    /// Components that vary, by axis.
    pub fields: Vec<(usize, FieldEntry)>,
    /// How they change with time.
    pub history: Option<LoadHistory>,
}

impl FixedPointEntry {
    /// Whether it prescribes displacements that grow with its load case: other than 0, and without
    /// the time in them.
    pub(crate) fn moves(&self) -> bool {
        is_moved(&self.displacement) || grows(&self.fields)
    }
}

/// Reads what acts on a part of the outer surface; rigid rock has no use for loads and supports.
pub(crate) fn read_boundary(section: &Section<'_, '_>, setting: Setting) -> Option<BoundaryEntry> {
    let fluid = read_boundary_fluid(section, setting);
    let (load, held, springs) = match setting.is_rigid() {
        true => (None, Held::default(), None),
        false => (
            read_load(section, setting),
            read_support(section, setting.clock),
            read_springs(section),
        ),
    };
    let names = [
        "traction",
        "pressure",
        "symmetry",
        "displacement",
        "spring",
        "far_field",
    ];
    // A place alone names a face, for probes and for other programs.
    let says_nothing = !section.has("where")
        && match setting.is_rigid() {
            true => section.table().is_empty(),
            false => fluid.is_none() && !names.into_iter().any(|name| section.has(name)),
        };
    if says_nothing {
        section.refuse(
            "traction",
            format!("{} says nothing", section.title),
            "add traction, pressure, displacement, symmetry, spring, far_field or fluid_pressure, or \
             remove the section",
        );
    }
    let moves = matches!(held.support, Some(Support::Displacement(own)) if is_moved(&own));
    let moves = moves || !held.fields.is_empty();
    let scaled = Scaled {
        is_there: load.is_some() || moves || fluid.is_some(),
        what: "a traction, a pressure, a displacement other than 0 or a fluid_pressure",
    };
    Some(BoundaryEntry {
        place: read_place(section),
        load,
        support: held.support,
        displacement_fields: held.fields,
        springs,
        fluid,
        history: read_history(section, setting.clock, scaled),
    })
}

fn read_place(section: &Section<'_, '_>) -> Option<SurfacePlace> {
    match SurfacePlace::read(section.text("where")?) {
        Ok(place) => Some(place),
        Err([problem, remedy]) => {
            section.refuse("where", problem, remedy);
            None
        }
    }
}

fn read_load(section: &Section<'_, '_>, setting: Setting) -> Option<LoadEntry> {
    let in_time = InTime::By(setting.clock);
    let traction = field::read_components(section, "traction", in_time);
    let pressure = read_value(section, "pressure", in_time);
    match (traction, pressure) {
        (Some(traction), None) => Some(traction_of(traction)),
        (None, Some(Value::Number(pressure))) => {
            Some(LoadEntry::Uniform(SurfaceLoad::Pressure(pressure)))
        }
        (None, Some(Value::Varying(entry))) => {
            Some(LoadEntry::Varying(Box::new(VaryingLoadEntry {
                load: LoadField::Pressure(entry.field.clone()),
                fields: vec![*entry],
            })))
        }
        (Some(_), Some(_)) => {
            let remedy = "keep one; a pressure p is the traction -p along the outward normal";
            section.refuse(
                "pressure",
                "both traction and pressure are given".into(),
                remedy,
            );
            None
        }
        (None, None) => None,
    }
}

/// A traction, uniform if none of its components varies.
fn traction_of(components: [Value; 3]) -> LoadEntry {
    if let [Value::Number(x), Value::Number(y), Value::Number(z)] = components {
        return LoadEntry::Uniform(SurfaceLoad::Traction(DVec3::new(x, y, z)));
    }
    let mut entries = Vec::new();
    let fields = components.map(|component| {
        let (field, entry) = field_of(component);
        entries.extend(entry);
        field
    });
    LoadEntry::Varying(Box::new(VaryingLoadEntry {
        load: LoadField::Traction(Box::new(fields)),
        fields: entries,
    }))
}

/// A support, and which of its components vary.
#[derive(Default)]
struct Held {
    support: Option<Support>,
    fields: Vec<(usize, FieldEntry)>,
}

fn read_support(section: &Section<'_, '_>, clock: Clock) -> Held {
    let symmetry = section.flag("symmetry");
    let displacement = section.section("displacement");
    let displacement = displacement.map(|own| read_components(own, clock));
    if symmetry == Some(true) && displacement.is_some() {
        let remedy = "keep one; symmetry already holds the normal direction";
        section.refuse(
            "symmetry",
            "both symmetry and displacement are given".into(),
            remedy,
        );
        return Held::default();
    }
    match displacement {
        Some((components, fields)) => Held {
            support: Some(Support::Displacement(components)),
            fields,
        },
        None => Held {
            support: (symmetry == Some(true)).then_some(Support::Symmetry),
            fields: Vec::new(),
        },
    }
}

fn read_springs(section: &Section<'_, '_>) -> Option<SpringEntry> {
    let normal = read_value(section, "spring", InTime::Never);
    let shear = read_value(section, "shear_spring", InTime::Never);
    let centre = section.vector("far_field");
    let refuse = |key, problem: &str, remedy| section.refuse(key, problem.into(), remedy);
    if section.has("shear_spring") && !section.has("spring") {
        refuse(
            "shear_spring",
            "`shear_spring` stands without `spring`",
            "add spring = 0 for springs along the surface alone",
        );
    }
    if section.has("spring") && section.has("far_field") {
        let remedy = "keep one: far_field chooses the stiffness of the springs by the rock";
        refuse("far_field", "both spring and far_field are given", remedy);
    }
    if let Some(centre) = centre {
        return Some(SpringEntry {
            stiffness: SpringStiffness::Outside {
                centre: centre.into(),
                // Until the mesh is known.
                is_line: false,
            },
            fields: Vec::new(),
        });
    }
    let normal = normal?;
    let [normal, shear] = [normal.clone(), shear.unwrap_or(normal)].map(field_of);
    let entries = [&normal, &shear].into_iter();
    Some(SpringEntry {
        fields: entries.filter_map(|(_, entry)| entry.clone()).collect(),
        stiffness: SpringStiffness::Bed {
            normal: normal.0,
            shear: shear.0,
        },
    })
}

/// The field of a value, and what is asked of it if it varies.
fn field_of(value: Value) -> (Field, Option<FieldEntry>) {
    match value {
        Value::Number(number) => (Field::constant(number), None),
        Value::Varying(entry) => (entry.field.clone(), Some(*entry)),
    }
}

/// Prescribed components (m), 0 where they vary, and those that vary.
fn read_components(
    section: Section<'_, '_>,
    clock: Clock,
) -> ([Option<f64>; 3], Vec<(usize, FieldEntry)>) {
    let axes = ["x", "y", "z"];
    let mut components = [None; 3];
    let mut fields = Vec::new();
    for (axis, key) in axes.into_iter().enumerate() {
        components[axis] = match read_value(&section, key, InTime::By(clock)) {
            Some(Value::Number(number)) => Some(number),
            Some(Value::Varying(entry)) => {
                fields.push((axis, *entry));
                Some(0.0)
            }
            None => None,
        };
    }
    if !axes.into_iter().any(|axis| section.has(axis)) {
        section.refuse(
            "x",
            format!("{} names no component", section.title),
            "name at least one: { x = 0.0, y = 0.0, z = 0.0 }",
        );
    }
    section.finish();
    (components, fields)
}

/// Reads a node held by itself.
pub(crate) fn read_fixed_point(section: &Section<'_, '_>, clock: Clock) -> Option<FixedPointEntry> {
    section.require("at");
    section.require("displacement");
    let at = section.vector("at");
    let displacement = section.section("displacement");
    let displacement = displacement.map(|own| read_components(own, clock));
    let moved = displacement.as_ref();
    let moved = moved.map(|(components, fields)| is_moved(components) || !fields.is_empty());
    let scaled = Scaled {
        is_there: moved.unwrap_or(true),
        what: "a displacement other than 0",
    };
    let history = read_history(section, clock, scaled);
    let (displacement, fields) = displacement?;
    Some(FixedPointEntry {
        at: at?.into(),
        displacement,
        fields,
        history,
    })
}

/// Reads what acts in all of the rock.
pub(crate) fn read_body(root: &Section<'_, '_>, clock: Clock) -> BodyEntry {
    let Some(section) = root.section("body") else {
        return BodyEntry::default();
    };
    section.require("gravity");
    let gravity = section.vector("gravity");
    let scaled = Scaled {
        is_there: true,
        what: "gravity",
    };
    let history = read_history(&section, clock, scaled);
    section.finish();
    BodyEntry {
        gravity: gravity.unwrap_or_default().into(),
        history,
    }
}

/// Whether any value has no time in it, and so grows with a load case.
fn grows(fields: &[(usize, FieldEntry)]) -> bool {
    let mut fields = fields.iter();
    fields.any(|(_, entry)| !entry.field.depends_on_time())
}

/// Whether any component is held elsewhere than where it is (m).
fn is_moved(components: &[Option<f64>; 3]) -> bool {
    components.iter().flatten().any(|value| *value != 0.0)
}
