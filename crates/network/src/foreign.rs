//! Lists of fractures as other programs write them: PorePy's CSV, the polygons of dfnWorks, and its
//! ellipses and rectangles.
//!
//! PorePy: an optional first line with two opposite corners of the domain, then one line for each
//! fracture with the coordinates of its corners, all of them plain numbers. dfnWorks: a line
//! `nPolygons: N`, then for each polygon its number of corners, and each corner in braces.

use glam::DVec3;
use kluft_defect::Defect;

use crate::clip::Domain;
use crate::foreign_line::{Corners, Line, Read};
use crate::foreign_user::UserFile;
use crate::fracture::InputFracture;
use crate::polygon::Polygon;

/// What a file of another program holds.
#[derive(Debug)]
pub struct ForeignList {
    /// Which program's it is.
    pub program: &'static str,
    /// The domain, if the file says it.
    pub domain: Option<Domain>,
    /// The fractures, named by the set and their number.
    pub fractures: Vec<InputFracture>,
}

/// Reads the text of a file that another program has written; `file` is for messages, and the
/// fractures belong to `set`. None if it is a file of no such program.
///
/// # Errors
/// Every defect with its line and a remedy.
pub fn read_foreign_list(
    text: &str,
    file: &str,
    set: &str,
) -> Option<Result<ForeignList, Vec<Defect>>> {
    let lines = text.trim_start_matches('\u{feff}').lines();
    let lines = lines.enumerate().map(|(number, line)| Line {
        place: format!("{file}:{}", number + 1),
        text: line.trim(),
    });
    let says_something = |line: &Line<'_>| !line.text.is_empty() && !line.text.starts_with('#');
    let lines: Vec<Line<'_>> = lines.filter(says_something).collect();
    let first = lines.first()?;
    let of_users = |count, is_elliptic| {
        let file = UserFile {
            lines: &lines,
            count,
            is_elliptic,
        };
        ("dfnWorks", file.read())
    };
    let is_numbers = |line: &Line<'_>| line.numbers().is_some();
    let (program, read) = match first.text.split_once(':') {
        Some(("nPolygons", count)) => ("dfnWorks", dfnworks(&lines, count)),
        Some(("nUserEll", count)) => of_users(count, true),
        Some(("nUserRect", count)) => of_users(count, false),
        _ if is_numbers(first) => ("PorePy", porepy(&lines)),
        _ => return None,
    };
    Some(read.and_then(|(domain, corners)| {
        let fractures = named(corners, set)?;
        Ok(ForeignList {
            program,
            domain,
            fractures,
        })
    }))
}

fn porepy(lines: &[Line<'_>]) -> Read {
    let mut domain = None;
    let mut all = Vec::new();
    let mut defects = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        match line.numbers().as_deref() {
            Some(&[a, b, c, d, e, f]) if index == 0 && a < d && b < e && c < f => {
                domain = Some(Domain::between([a, b, c], [d, e, f]));
            }
            Some(numbers) if numbers.len() >= 9 && numbers.len() % 3 == 0 => all.push(Corners {
                place: line.place.clone(),
                corners: numbers.chunks(3).map(DVec3::from_slice).collect(),
            }),
            Some(numbers) => defects.push(line.defect(
                format!("{} numbers make no polygon", numbers.len()),
                "write x, y, z of each corner, three corners or more; only the first line may hold \
                 two opposite corners of the domain",
            )),
            None => defects.push(line.defect(
                format!(
                    "`{}` holds something else than numbers",
                    shortened(line.text)
                ),
                "write x, y, z of each corner, with commas between",
            )),
        }
    }
    match defects.is_empty() {
        true => Ok((domain, all)),
        false => Err(defects),
    }
}

fn dfnworks(lines: &[Line<'_>], count: &str) -> Read {
    let mut defects = Vec::new();
    let polygons: Vec<&Line<'_>> = lines.iter().skip(1).collect();
    if count.trim().parse::<usize>().ok() != Some(polygons.len()) {
        defects.push(lines[0].defect(
            format!(
                "{} polygons are promised, and {} follow",
                count.trim(),
                polygons.len()
            ),
            "write the number of the lines that follow, one for each polygon",
        ));
    }
    let mut all = Vec::new();
    for line in polygons {
        match braced(line.text) {
            Some(corners) => all.push(Corners {
                place: line.place.clone(),
                corners,
            }),
            None => defects.push(line.defect(
                format!("`{}` is no polygon", shortened(line.text)),
                "write the number of corners, then each as {x, y, z}",
            )),
        }
    }
    match defects.is_empty() {
        true => Ok((None, all)),
        false => Err(defects),
    }
}

/// `4 {x, y, z} {x, y, z} {x, y, z} {x, y, z}`.
fn braced(text: &str) -> Option<Vec<DVec3>> {
    let (count, rest) = text.split_once('{')?;
    let mut corners = Vec::new();
    for part in rest.split('{') {
        let inside = part.trim_end().strip_suffix('}')?;
        let line = Line {
            place: String::new(),
            text: inside,
        };
        corners.push(DVec3::from(<[f64; 3]>::try_from(line.numbers()?).ok()?));
    }
    (count.trim().parse::<usize>().ok() == Some(corners.len())).then_some(corners)
}

/// The beginning of a text.
fn shortened(text: &str) -> String {
    const SHOWN: usize = 40;
    match text.chars().count() {
        0..=SHOWN => text.to_owned(),
        _ => text.chars().take(SHOWN).chain("...".chars()).collect(),
    }
}

fn named(all: Vec<Corners>, set: &str) -> Result<Vec<InputFracture>, Vec<Defect>> {
    let mut defects = Vec::new();
    let mut fractures = Vec::new();
    for (number, Corners { place, corners }) in (1..).zip(all) {
        match Polygon::through(&corners) {
            Ok(polygon) => fractures.push(InputFracture {
                name: format!("{set}-{number}"),
                set: set.to_owned(),
                place,
                polygon,
            }),
            Err((problem, remedy)) => defects.push(Defect::new(place, problem, remedy)),
        }
    }
    match defects.is_empty() {
        true => Ok(fractures),
        false => Err(defects),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ForeignList, Vec<Defect>> {
        read_foreign_list(text, "list", "fractures").expect("a list of another program")
    }

    #[test]
    fn a_list_of_porepy_has_a_domain_and_corners() {
        let list = read(
            "0,0,0,1,2.25,1\n0.05,0.25,0.5,0.95,0.25,0.5,0.95,2,0.5,0.05,2,0.5\n\n0,0,0, 1,0,0, 0,1,0,\n",
        );
        let list = list.expect("a list");
        assert_eq!(list.program, "PorePy");
        assert_eq!(
            list.domain.expect("a domain").high,
            DVec3::new(1.0, 2.25, 1.0)
        );
        let areas: Vec<f64> = list.fractures.iter().map(|f| f.polygon.area()).collect();
        assert!((areas[0] - 0.9 * 1.75).abs() < 1e-12 && (areas[1] - 0.5).abs() < 1e-12);
        assert_eq!(list.fractures[1].name, "fractures-2");
        assert_eq!(list.fractures[1].place, "list:4");
    }

    #[test]
    fn a_list_of_porepy_may_have_no_domain() {
        let list = read("0,0,0,1,0,0,0,1,0\n").expect("a list");
        assert!(list.domain.is_none() && list.fractures.len() == 1);
    }

    #[test]
    fn polygons_of_dfnworks_are_read() {
        let text =
            "nPolygons: 2\n4 {0, 0, 0} {2, 0, 0} {2, 1, 0} {0, 1, 0} \n3 {0,0,1} {1,0,1} {0,1,1}\n";
        let list = read(text).expect("a list");
        assert_eq!((list.program, list.fractures.len()), ("dfnWorks", 2));
        assert!((list.fractures[0].polygon.area() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn every_defect_is_told_with_its_line() {
        for (text, places) in [
            (
                "0,0,0,1,0,0,0,1,0\n1,2,3,4\na,b\n",
                &["list:2: 4 numbers", "list:3: `a,b`"][..],
            ),
            (
                "nPolygons: 3\n3 {0,0,1} {1,0,1} {0,1,1}\n4 {0,0,1} {1,0,1} {0,1,1}\n",
                &["list:1: 3 polygons", "list:3: `4 {0"],
            ),
            ("0,0,0,1,0,0,2,0,0\n", &["list:1"]),
        ] {
            let defects = read(text).expect_err(text);
            assert_eq!(defects.len(), places.len(), "{defects:#?}");
            for (defect, place) in defects.iter().zip(places) {
                assert!(defect.to_string().starts_with(place), "{defect}");
            }
        }
        assert!(read_foreign_list("name,shape\n", "list", "a").is_none());
        assert!(read_foreign_list("", "list", "a").is_none());
    }

    fn assert_near(found: f64, wanted: f64) {
        assert!(
            (found - wanted).abs() < 1e-12 * wanted.abs().max(1.0),
            "{found} {wanted}"
        );
    }

    /// A regular octagon, whose area is `2 sqrt(2) r^2`.
    #[test]
    fn ellipses_by_trend_and_plunge_are_read() {
        let list = read(
            "nUserEll: 1 \n \nRadii: \n100 \n\nAspect_Ratio: \n1 \n\nBeta: \n0 \n\nAngleOption: \ndegree \n\n\
             Translation: \n[0, 0, 25] \n\nuserOrientationOption: 1 \n \nTrend_Plunge: \n[45, 35] \n\n\
             aperture \nNone \n\nNumber_of_Vertices: \n8 \n\n",
        );
        let list = list.expect("a list");
        let polygon = &list.fractures[0].polygon;
        assert_eq!((list.program, list.fractures.len()), ("dfnWorks", 1));
        assert_near(polygon.area(), 8_f64.sqrt() * 1e4);
        let [trend, plunge] = [45_f64, 35.0].map(f64::to_radians);
        let normal = DVec3::new(
            trend.cos() * plunge.cos(),
            trend.sin() * plunge.cos(),
            plunge.sin(),
        );
        assert_near(polygon.normal().dot(normal).abs(), 1.0);
        let middle = polygon.corners().iter().sum::<DVec3>() / 8.0;
        assert_near(middle.distance(DVec3::new(0.0, 0.0, 25.0)), 0.0);
    }

    #[test]
    fn rectangles_are_turned_in_their_plane_and_with_it() {
        let text = "nUserRect: 2\nRadii:\n0.6\n1.0\nAspect_Ratio:\n1\n0.65\nBeta:\n0\n1.5707963267948966\n\
                    AngleOption:\nradian\nradian\nTranslation:\n[-0.4, 0, 0]\n[0, 0, 0]\n\
                    userOrientationOption: 0\nNormal:\n[0, 0, 2]\n[1, 0, 0]\n";
        let list = read(text).expect("a list");
        let [level, upright] = [0, 1].map(|index| &list.fractures[index].polygon);
        assert_near(level.area(), 1.44);
        assert_near(upright.area(), 2.6);
        // The long half axis goes from x to y by the turn, and stays there as z goes to x.
        let most = |of: fn(&DVec3) -> f64| upright.corners().iter().map(of).fold(0.0, f64::max);
        assert_near(most(|corner| corner.y), 1.0);
        assert_near(most(|corner| corner.z), 0.65);
        assert_eq!(list.fractures[1].place, "list:4");
        let short = read(&text.replace("0.65\n", "")).expect_err("a line is missing");
        assert!(short[0].to_string().contains("Aspect_Ratio"), "{short:?}");
        let many = text.replace("nUserRect: 2", "nUserRect: 99999999999999999999");
        assert!(read(&many).is_err());
        let wrong = read(&text.replace("[1, 0, 0]", "[0, 0, 0]")).expect_err("no normal");
        assert!(wrong[0].to_string().starts_with("list:20"), "{wrong:?}");
    }
}
