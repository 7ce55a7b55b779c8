//! The arrangement of a network for gmsh's own kernel: points, lines, plane surfaces, and what is
//! embedded in them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Write};

use crate::arrangement::{Arrangement, Face, faces};
use crate::clip::FACES;
use crate::geo_template::List;

/// Points and lines of an arrangement by their numbers, and the lines' tags in gmsh.
pub(crate) struct Lines(BTreeMap<[usize; 2], usize>);

impl Lines {
    /// Numbers all edges.
    pub(crate) fn of(arrangement: &Arrangement) -> Self {
        let edges: BTreeSet<[usize; 2]> = arrangement
            .sheets
            .iter()
            .flat_map(|sheet| sheet.edges())
            .collect();
        Self(edges.into_iter().zip(1..).collect())
    }

    /// Tags of the lines around a face, negative where they run the other way.
    fn around(&self, ring: &[usize]) -> Vec<String> {
        let next = ring.iter().cycle().skip(1);
        let tags = ring.iter().zip(next).map(|(&a, &b)| {
            let tag = self.0.get(&[a.min(b), a.max(b)]).copied().unwrap_or(0);
            if a < b {
                tag.to_string()
            } else {
                format!("-{tag}")
            }
        });
        tags.collect()
    }
}

/// Writes the points and lines.
pub(crate) fn points(out: &mut String, arrangement: &Arrangement, lines: &Lines) -> fmt::Result {
    let used = arrangement.sheets.iter().flat_map(|sheet| sheet.points());
    for point in used.collect::<BTreeSet<usize>>() {
        let at = List(&arrangement.points[point].to_array()).to_string();
        writeln!(out, "Point({}) = {at};", point + 1)?;
    }
    for ([a, b], tag) in &lines.0 {
        writeln!(out, "Line({tag}) = {{{}, {}}};", a + 1, b + 1)?;
    }
    Ok(())
}

/// Writes the surfaces, each whole or split along the closed loops of its traces.
pub(crate) fn surfaces(
    out: &mut String,
    arrangement: &Arrangement,
    lines: &Lines,
    is_split: bool,
) -> fmt::Result {
    let mut embedded = String::new();
    let mut parts: Vec<Vec<String>> = Vec::new();
    let (mut loops, mut tag) = (0, 0);
    for sheet in &arrangement.sheets {
        let faces = match is_split {
            true => faces(sheet, &arrangement.points),
            false => vec![Face::whole(sheet)],
        };
        let mut tags = Vec::new();
        for face in faces {
            tag += 1;
            let mut rings = Vec::new();
            for ring in &face.rings {
                loops += 1;
                writeln!(
                    out,
                    "Curve Loop({loops}) = {{{}}};",
                    lines.around(ring).join(", ")
                )?;
                rings.push(loops.to_string());
            }
            writeln!(out, "Plane Surface({tag}) = {{{}}};", rings.join(", "))?;
            embed(&mut embedded, &face, lines, tag)?;
            tags.push(tag.to_string());
        }
        parts.push(tags);
    }
    let (fractures, around) = parts.split_at(parts.len() - FACES.len());
    writeln!(
        out,
        "Surface Loop(1) = {{{}}};\nVolume(1) = {{1}};",
        around.concat().join(", ")
    )?;
    // gmsh takes its whole model over at each of these that follows something else.
    out.push_str(&embedded);
    if !fractures.is_empty() {
        writeln!(
            out,
            "Surface{{{}}} In Volume{{1}};",
            fractures.concat().join(", ")
        )?;
    }
    for (index, tags) in fractures.iter().enumerate() {
        writeln!(out, "piece_{index}() = {{{}}};", tags.join(", "))?;
    }
    for ((face, ..), tags) in FACES.iter().zip(around) {
        writeln!(out, "{face}() = {{{}}};", tags.join(", "))?;
    }
    Ok(())
}

fn embed(out: &mut String, face: &Face, lines: &Lines, tag: usize) -> fmt::Result {
    if !face.traces.is_empty() {
        let tags = face.traces.iter().filter_map(|trace| lines.0.get(trace));
        let tags: Vec<String> = tags.map(usize::to_string).collect();
        writeln!(out, "Line{{{}}} In Surface{{{tag}}};", tags.join(", "))?;
    }
    if !face.contacts.is_empty() {
        let tags: Vec<String> = face
            .contacts
            .iter()
            .map(|point| (point + 1).to_string())
            .collect();
        writeln!(out, "Point{{{}}} In Surface{{{tag}}};", tags.join(", "))?;
    }
    Ok(())
}
