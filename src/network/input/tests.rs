//! Descriptions of networks, and the keys that they may have.

use kluft_keys::KeySection as Keys;

use super::*;

const OVERRIDES: Overrides = Overrides {
    domain: None,
    h: None,
    keep_small: false,
    hydraulic_aperture: None,
};

/// Every key but those that exclude others.
const EVERY_KEY: &str = r#"
title = "Everything"
seed = 3
[domain]
low = [0, 0, "0 m"]
high = ["1000 cm", 10, 10]
[mesh]
h = "1 m"
h_fracture = 0.5
h_intersection = 0.4
growth = 0.3
small = 0.1
small_angle = "0.1 rad"
mend = false
[rock.rock]
young_modulus = "50 GPa"
poisson_ratio = 0.25
[fluid]
viscosity = "1 mPa s"
isolated = "refuse"
[[source]]
at = [5, 5, 5]
rate = 1e-4
radius = 0.1
[fracture_set.disc]
orientation = { dip = "80 degrees", dip_direction = 10, kappa = 30 }
size = { law = "power", exponent = 2.5, min = "1 m", max = 4 }
p32 = "0.1 m2/m3"
hydraulic_aperture = "0.1 mm"
shape = "disc"
sides = 8
seed = 5
aperture = "0.5 mm"
normal_stiffness = "20 GPa/m"
shear_stiffness = 1e10
[fracture_set.rectangle]
orientation = { dip = 10, dip_direction = 100, kappa = 50 }
size = { law = "lognormal", mean = 2, sd = 0.5, min = 1, max = 4 }
shape = "rectangle"
aspect = 1.5
count = 4
sealed = true
aperture = 5e-4
normal_stiffness = 4e10
shear_stiffness = 1e10
[fracture_set.alike]
orientation = { dip = 10, dip_direction = 100, kappa = 50 }
size = { law = "constant", radius = 1 }
count = 2
hydraulic_aperture_law = { coefficient = "10 um", exponent = 0.5 }
aperture = 5e-4
normal_stiffness = 4e10
shear_stiffness = 1e10
[[fracture]]
name = "a"
set = "alike"
shape = "disc"
centre = [5, 5, 5]
dip = 30
dip_direction = 0
radius = 1
sides = 5
rotation = 10
[[fracture]]
name = "b"
set = "alike"
shape = "ellipse"
centre = [5, 5, 5]
dip = 30
dip_direction = 0
semi_major = 2
semi_minor = 1
[[fracture]]
name = "c"
set = "alike"
shape = "rectangle"
centre = [5, 5, 5]
dip = 30
dip_direction = 0
length = 2
width = 1
[[fracture]]
name = "d"
set = "alike"
shape = "polygon"
points = [[0, 0, 0], [1, 0, 0], [0, "100 cm", 0]]
"#;

fn read(text: &str) -> (Option<Input>, Vec<Defect>, Vec<String>) {
    let source = Source::new("network.toml", text, Document::Network);
    let table = source.parse().expect("TOML");
    let root = Section::root(&source, table.get_ref());
    let mut defects = Vec::new();
    let input = read_description(&source, &root, Path::new("."), &OVERRIDES, &mut defects);
    root.finish();
    let unasked = source.unasked();
    defects.extend(source.into_defects());
    (input, defects, unasked)
}

/// A key that is asked for and not in the table stops the reader; this is the other direction.
/// Those that a scene has too are asked for by its reader.
#[test]
fn every_key_of_the_table_is_asked_for() {
    let (_, defects, mut unasked) = read(EVERY_KEY);
    assert_eq!(defects, []);
    let of_scenes = Document::Scene.sections();
    let is_of_scenes =
        |section: &&Keys| of_scenes.iter().any(|other| std::ptr::eq(*other, *section));
    let sections = Document::Network.sections();
    let own: Vec<&str> = sections
        .iter()
        .filter(|section| !is_of_scenes(section))
        .map(|section| section.pattern)
        .collect();
    unasked.retain(|key| {
        own.iter()
            .any(|pattern| key.starts_with(&format!("{pattern} ")))
    });
    assert_eq!(unasked, Vec::<String>::new());
}

#[test]
fn quantities_may_have_units() {
    let input = read(EVERY_KEY).0.expect("an input");
    assert_eq!(input.domain.high, DVec3::splat(10.0));
    assert_eq!(input.sizes.h, 1.0);
    assert_eq!(input.sizes.small_angle, 0.1_f64.to_degrees());
    let wrong = EVERY_KEY.replace("p32 = \"0.1 m2/m3\"", "p32 = \"0.1 m\"");
    let defects = read(&wrong).1;
    assert!(
        defects[0].problem.contains("`m` is the unit of a length"),
        "{defects:?}"
    );
}

#[test]
fn the_columns_of_a_list_are_those_of_the_table() {
    let columns = kluft_keys::network::LIST.keys.iter();
    let columns: Vec<&str> = columns.map(|key| key.name).collect();
    let defects = read_list("qqqqqqqqqqqq\n", "list.csv", "set", false).expect_err("unknown");
    assert_eq!(defects[0].remedy, format!("known: {}", columns.join(", ")));
}
