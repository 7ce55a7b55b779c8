//! Fractures that users of dfnWorks define: ellipses (`nUserEll: N`) and rectangles
//! (`nUserRect: N`), sections of N lines each, behind lines that name them.
//!
//! A fracture lies in the plane z = 0 with half axes of its radius along x and radius times aspect
//! ratio along y, is turned by `Beta` around z, then as z goes to its normal, and moved by its
//! translation. The normal of a trend t and a plunge p is (cos t cos p, sin t cos p, sin p), that
//! of a dip d and a strike s is (sin d sin s, -sin d cos s, cos d).

use glam::{DQuat, DVec3};
use kluft_defect::Defect;

use crate::foreign_line::{Corners, Line, Read};

/// Corners of an ellipse whose file says no number.
const CORNERS: f64 = 8.0;
const MOST_CORNERS: f64 = 1000.0;

/// A file of dfnWorks with one kind of fractures.
pub(crate) struct UserFile<'a> {
    pub(crate) lines: &'a [Line<'a>],
    /// The number of fractures, as its first line has it.
    pub(crate) count: &'a str,
    pub(crate) is_elliptic: bool,
}

impl UserFile<'_> {
    /// The corners of all fractures.
    ///
    /// # Errors
    /// The first section that is missing or has other lines than there are fractures.
    pub(crate) fn read(&self) -> Read {
        self.fractures()
            .map(|all| (None, all))
            .map_err(|defect| vec![defect])
    }

    fn fractures(&self) -> Result<Vec<Corners>, Defect> {
        let radii = self.numbers::<1>("Radii:")?;
        let aspects = self.numbers::<1>("Aspect_Ratio:")?;
        let turns = self.numbers::<1>("Beta:")?;
        let units = self.units()?;
        let places = self.numbers::<3>("Translation:")?;
        let normals = self.normals(&units)?;
        let rows = self.rows("Radii:")?;
        let mut all = Vec::new();
        for (index, row) in rows.iter().enumerate() {
            let [[radius], [aspect]] = [radii[index], aspects[index]];
            let to_place = DQuat::from_rotation_arc(DVec3::Z, normals[index])
                * DQuat::from_rotation_z(turns[index][0] * units[index]);
            let half = DVec3::new(radius, radius * aspect, 0.0);
            let corners = self.outline(index)?.into_iter();
            let corners = corners
                .map(|corner| to_place * (corner * half) + DVec3::from(places[index]))
                .collect();
            all.push(Corners {
                place: row.place.clone(),
                corners,
            });
        }
        Ok(all)
    }

    /// Corners of a fracture whose half axes are one.
    fn outline(&self, index: usize) -> Result<Vec<DVec3>, Defect> {
        if !self.is_elliptic {
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            return Ok(corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec());
        }
        let count = match self.heading("Number_of_Vertices:") {
            Some(_) => self.numbers::<1>("Number_of_Vertices:")?[index][0],
            None => CORNERS,
        };
        if !(3.0..=MOST_CORNERS).contains(&count) {
            let row = &self.rows("Number_of_Vertices:")?[index];
            let remedy = format!("write 3 to {MOST_CORNERS}");
            return Err(row.defect(format!("{count} corners make no ellipse"), &remedy));
        }
        let count = count as usize;
        let angle = |corner: usize| std::f64::consts::TAU * corner as f64 / count as f64;
        let corners =
            (0..count).map(|corner| DVec3::new(angle(corner).cos(), angle(corner).sin(), 0.0));
        Ok(corners.collect())
    }

    /// Unit normals by whichever way the file has.
    fn normals(&self, units: &[f64]) -> Result<Vec<DVec3>, Defect> {
        let of_angles = |name: &str, of: fn(f64, f64) -> DVec3| {
            let angles = self.numbers::<2>(name)?.into_iter().zip(units);
            Ok(angles
                .map(|([a, b], unit)| of(a * unit, b * unit))
                .collect())
        };
        if self.heading("Trend_Plunge:").is_some() {
            return of_angles("Trend_Plunge:", |t, p| {
                DVec3::new(t.cos() * p.cos(), t.sin() * p.cos(), p.sin())
            });
        }
        if self.heading("Dip_Strike:").is_some() {
            return of_angles("Dip_Strike:", |d, s| {
                DVec3::new(d.sin() * s.sin(), -d.sin() * s.cos(), d.cos())
            });
        }
        let rows = self.rows("Normal:")?.iter();
        let normals = rows.zip(self.numbers::<3>("Normal:")?);
        normals
            .map(|(row, normal)| {
                let unit = DVec3::from(normal).try_normalize();
                unit.ok_or_else(|| row.defect("the normal is zero".into(), "write its direction"))
            })
            .collect()
    }

    /// What one of the unit of angles of each fracture is in radians.
    fn units(&self) -> Result<Vec<f64>, Defect> {
        let rows = self.rows("AngleOption:")?.iter();
        rows.map(|row| match row.text {
            "degree" => Ok(1_f64.to_radians()),
            "radian" => Ok(1.0),
            other => Err(row.defect(
                format!("`{other}` is no unit of angles"),
                "write degree or radian",
            )),
        })
        .collect()
    }

    fn heading(&self, name: &str) -> Option<usize> {
        self.lines.iter().position(|line| line.text == name)
    }

    /// The lines of a section, one for each fracture.
    fn rows(&self, name: &str) -> Result<&[Line<'_>], Defect> {
        let first = &self.lines[0];
        let count: usize = self.count.trim().parse().map_err(|_| {
            let problem = format!("`{}` is no number of fractures", self.count.trim());
            first.defect(problem, "write how many the file has")
        })?;
        let begin = self.heading(name).map(|at| at + 1);
        let rows = begin.and_then(|begin| self.lines.get(begin..)?.get(..count));
        rows.ok_or_else(|| {
            let problem = format!("there are no {count} lines behind `{name}`");
            first.defect(problem, "write one for each fracture")
        })
    }

    /// The numbers of a section, N on each line, in brackets or not.
    fn numbers<const N: usize>(&self, name: &str) -> Result<Vec<[f64; N]>, Defect> {
        let rows = self.rows(name)?.iter();
        rows.map(|row| {
            let inside = Line {
                place: row.place.clone(),
                text: row.text.trim_start_matches('[').trim_end_matches(']'),
            };
            let numbers = inside.numbers().and_then(|all| all.try_into().ok());
            numbers.ok_or_else(|| {
                let problem = format!("`{}` is not {N} of `{name}`", row.text);
                row.defect(
                    problem,
                    "write finite numbers with commas between, in brackets",
                )
            })
        })
        .collect()
    }
}
