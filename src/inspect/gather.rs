//! From the survey of a mesh to findings with names.

use kluft_mesh::{BlockSurvey, Contact, Mesh, Survey, cell_angles, facet_centre};
use kluft_solver::Problem;

use super::findings::{
    BlockFinding, CellFinding, CellFindings, ContactFinding, FractureFinding, Inspection,
    PatchFinding, box_of,
};

/// Cells below this quality are worth a warning.
const POOR: f64 = 0.05;
/// Fractures that meet at a smaller angle (degrees) are worth a warning.
const SHARP: f64 = 10.0;

const MEASURE: &str = "equiangle: the smallest and the largest dihedral angle against those of the \
                       regular cell, whichever is worse; 1 is regular, 0 is flat";

/// Everything that needs no scene.
pub fn topology(mesh: &Mesh, survey: &Survey, inspection: &mut Inspection) {
    inspection.mesh.bounds = Some(box_of(mesh.bounds()));
    inspection.fractures = (0..mesh.fractures.len())
        .map(|index| fracture(mesh, survey, index))
        .collect();
    inspection.contacts = survey.contacts.iter().map(|c| contact(mesh, c)).collect();
    let patches = survey.unresolved_patches.iter();
    inspection.unresolved_patches = patches
        .map(|patch| PatchFinding {
            fracture: mesh.fractures[patch.fracture as usize].clone(),
            facets: patch.facets,
            area: patch.area,
            at: patch.centre.to_array(),
            whole: patch.whole,
        })
        .collect();
    inspection.blocks = survey.blocks.iter().map(|b| block(mesh, b)).collect();
    inspection.cells = (!mesh.cells.is_empty()).then(|| cells(mesh, survey));
    warn(inspection);
}

fn fracture(mesh: &Mesh, survey: &Survey, index: usize) -> FractureFinding {
    let found = &survey.fractures[index];
    let patches = survey.unresolved_patches.iter();
    let own = patches.filter(|patch| patch.fracture as usize == index);
    let open = |value: f64| (!found.closed).then_some(value);
    FractureFinding {
        name: mesh.fractures[index].clone(),
        facets: found.facets,
        area: found.area,
        dip: open(found.orientation.dip),
        dip_direction: open(found.orientation.dip_direction),
        deviation: open(found.orientation.deviation),
        closed: found.closed,
        components: found.components,
        bounds: box_of(found.bounds),
        tip_edges: found.tip_edges,
        tip_length: found.tip_length,
        trace_edges: found.trace_edges,
        trace_length: found.trace_length,
        branching_length: found.branching_length,
        junction_nodes: found.junction_nodes.into(),
        unresolved_facets: own.map(|patch| patch.facets).sum(),
        worst_cell: survey.quality.worst_of_fracture[index].map(|worst| cell(mesh, survey, worst)),
    }
}

fn contact(mesh: &Mesh, contact: &Contact) -> ContactFinding {
    let [first, second] = contact.ending_length;
    let kinds = [
        (contact.crossing_length, "crosses"),
        (first, "first ends on second"),
        (second, "second ends on first"),
        (contact.rim_length, "rim to rim"),
    ];
    let longest = kinds.into_iter().filter(|(length, _)| *length > 0.0);
    let kind = longest.max_by(|a, b| a.0.total_cmp(&b.0));
    ContactFinding {
        fractures: contact
            .fractures
            .map(|fracture| mesh.fractures[fracture as usize].clone()),
        kind: kind.map_or("touches", |(_, kind)| kind),
        crossing_length: contact.crossing_length,
        first_ends_length: first,
        second_ends_length: second,
        rim_length: contact.rim_length,
        nodes: contact.nodes,
        smallest_angle: contact.smallest_angle,
        at: contact.at.to_array(),
    }
}

fn block(mesh: &Mesh, block: &BlockSurvey) -> BlockFinding {
    let chosen = |names: &mut dyn Iterator<Item = &String>, flags: &[bool]| -> Vec<String> {
        let pairs = names.zip(flags);
        pairs
            .filter(|(_, on)| **on)
            .map(|(name, _)| name.clone())
            .collect()
    };
    BlockFinding {
        cells: block.cells,
        volume: block.volume,
        bounds: box_of(block.bounds),
        boundaries: chosen(
            &mut mesh.boundaries.iter().map(|b| &b.name),
            &block.on_boundary,
        ),
        fractures: chosen(&mut mesh.fractures.iter(), &block.on_fracture),
        supported: None,
        loaded: None,
        held_by_fractures_only: None,
    }
}

fn cells(mesh: &Mesh, survey: &Survey) -> CellFindings {
    let quality = &survey.quality;
    let named = |cells: &[u32]| {
        cells
            .iter()
            .map(|&worst| cell(mesh, survey, worst))
            .collect()
    };
    CellFindings {
        measure: MEASURE,
        mean_quality: quality.of_cell.iter().sum::<f64>() / quality.of_cell.len() as f64,
        histogram: quality.histogram,
        worst: named(&quality.worst),
        worst_at_fractures: named(&quality.worst_at_fractures),
    }
}

fn cell(mesh: &Mesh, survey: &Survey, index: u32) -> CellFinding {
    let index = index as usize;
    let angles = cell_angles(mesh, index);
    let nodes = mesh.cells.nodes_of(index).iter();
    let touched = nodes.flat_map(|&node| survey.at_nodes.of(node as usize));
    let mut touched: Vec<u32> = touched.copied().collect();
    touched.sort_unstable();
    touched.dedup();
    let names = touched
        .into_iter()
        .map(|f| mesh.fractures[f as usize].clone());
    CellFinding {
        tag: mesh.cell_tags[index],
        quality: angles.quality,
        smallest_angle: angles.smallest,
        largest_angle: angles.largest,
        at: facet_centre(&mesh.corners(&mesh.cells, index)).to_array(),
        fractures: names.collect(),
    }
}

fn warn(inspection: &mut Inspection) {
    let mut warnings = Vec::new();
    for patch in inspection
        .unresolved_patches
        .iter()
        .filter(|patch| patch.whole)
    {
        let [x, y, z] = patch.at;
        warnings.push(format!(
            "fracture `{}`: a patch of {} facets at ({x:.4}, {y:.4}, {z:.4}) has no jump, so it stays welded: mesh it finer",
            patch.fracture, patch.facets
        ));
    }
    for contact in &inspection.contacts {
        let [x, y, z] = contact.at;
        let [first, second] = &contact.fractures;
        match contact.smallest_angle {
            Some(angle) if angle < SHARP => warnings.push(format!(
                "fractures `{first}` and `{second}` meet at {angle:.1} degrees at ({x:.4}, {y:.4}, {z:.4})"
            )),
            None => warnings.push(format!(
                "fractures `{first}` and `{second}` touch at {} nodes without a common edge, at ({x:.4}, {y:.4}, {z:.4})",
                contact.nodes
            )),
            Some(_) => {}
        }
    }
    let worst = inspection
        .cells
        .iter()
        .filter_map(|cells| cells.worst.first());
    for cell in worst.filter(|cell| cell.quality < POOR) {
        let beside = match cell.fractures.is_empty() {
            true => "away from fractures".to_owned(),
            false => format!("at {}", cell.fractures.join(", ")),
        };
        warnings.push(format!(
            "cell {} {beside} is almost flat: dihedral angles from {:.2} to {:.2} degrees",
            cell.tag, cell.smallest_angle, cell.largest_angle
        ));
    }
    inspection.warnings.extend(warnings);
}

/// Which blocks supports hold and loads push.
pub fn held_and_loaded(problem: &Problem, inspection: &mut Inspection) {
    let mesh = &problem.mesh;
    let mut fixed = vec![false; mesh.nodes.len()];
    for point in &problem.fixed_points {
        fixed[point.node as usize] = true;
    }
    let mut holds_fixed = vec![false; mesh.block_count];
    if !problem.fixed_points.is_empty() {
        for (cell, &block) in mesh.block.iter().enumerate() {
            let mut nodes = mesh.cells.nodes_of(cell).iter();
            holds_fixed[block as usize] |= nodes.any(|&node| fixed[node as usize]);
        }
    }
    let names = |wanted: &dyn Fn(&kluft_solver::Condition) -> bool| -> Vec<&str> {
        let conditions = problem.conditions.iter().filter(|c| wanted(c));
        conditions
            .map(|c| mesh.boundaries[c.boundary].name.as_str())
            .collect()
    };
    let supports = names(&|condition| condition.support.is_some());
    let springs = problem.springs.iter();
    let springs = springs.map(|spring| mesh.boundaries[spring.boundary].name.as_str());
    let supports: Vec<&str> = supports.into_iter().chain(springs).collect();
    let loads = names(&|condition| condition.load.is_some());
    for (block, fixed) in inspection.blocks.iter_mut().zip(holds_fixed) {
        let on = |chosen: &[&str]| {
            let mut own = block.boundaries.iter();
            own.any(|name| chosen.contains(&name.as_str()))
        };
        let supported = fixed || on(&supports);
        block.loaded = Some(on(&loads));
        block.supported = Some(supported);
        block.held_by_fractures_only = Some(!supported && !block.fractures.is_empty());
    }
}
