//! Hydraulic apertures by the size of fractures.

use kluft_network::ApertureLaw;
use kluft_scene::reader::Section;
use kluft_scene::{FluidUse, Setting, read_fracture};

/// Reads the law of a set, and what else the set says of its fractures.
pub(super) fn read_aperture_law(
    section: &Section<'_, '_>,
    setting: Setting,
) -> Option<ApertureLaw> {
    let law = section.section("hydraulic_aperture_law")?;
    for key in [
        "hydraulic_aperture",
        "residual_hydraulic_aperture",
        "roughness",
        "joint_roughness",
        "sealed",
    ] {
        if section.has(key) {
            let problem = format!("`{key}` has no effect beside hydraulic_aperture_law");
            section.refuse(key, problem, "keep one of them");
        }
    }
    match setting.fluid {
        FluidUse::None => section.refuse(
            "hydraulic_aperture_law",
            "`hydraulic_aperture_law` is given, but there is no [fluid]".into(),
            "add [fluid] with viscosity = 1e-3 (Pa s), or remove it",
        ),
        FluidUse::InRigidRock => {
            section.number("aperture");
            section.number("fluid_pressure");
        }
        FluidUse::InElasticRock => {
            // Its walls follow the law of any fracture; the fluid does not see them.
            let setting = Setting {
                fluid: FluidUse::None,
                ..setting
            };
            read_fracture(section, setting);
        }
    }
    law.require("coefficient");
    law.require("exponent");
    let (coefficient, exponent) = (law.number("coefficient"), law.number("exponent"));
    law.finish();
    Some(ApertureLaw {
        coefficient: coefficient?,
        exponent: exponent?,
    })
}
