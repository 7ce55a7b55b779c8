//! From the end of one stage to the beginning of the next, whose cells are others: what stays
//! carries its stress on, what comes is free of stress, and what held the cut walls lets go.
//!
//! The unknowns of a stage begin at zero. A point has moved by `U + u`, with `U` what it had moved
//! before; a cell is strained by that, and by an offset of its own where it was added later than
//! its points moved, or where points of different displacement became one. See
//! `docs/design/stages.md`.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;
use lie_core::JointHistory;

use super::System;
use super::carried::{Carried, LeftPoint, StageEnd};
use super::spread_displacements::spread;
use super::state::{FacetPointState, State};
use crate::assembly::loads::Loads;
use crate::space::cell::StrainOffsets;

impl System<'_> {
    /// What a state at the end of a stage leaves to the next; `cells` are the numbers of the cells,
    /// ascending.
    pub fn leave(&self, state: &State, cells: &[u32]) -> StageEnd {
        let mesh = &self.problem.mesh;
        let of_slot = &self.discretisation.points.of_cell_node;
        let total = self.total_displacements(state);
        let displacements: Vec<DVec3> = of_slot.iter().map(|&p| total[p as usize]).collect();
        let mut strains = displacements.clone();
        for (&cell, offsets) in &self.strain_offsets().0 {
            let own = &mut strains[mesh.cells.range(cell as usize)];
            own.iter_mut().zip(offsets).for_each(|(u, by)| *u += *by);
        }
        let facets = &mesh.facets;
        let sides = facets.minus.iter().zip(&facets.plus);
        let number = |cell: &u32| cells[*cell as usize];
        StageEnd {
            cells: cells.to_vec(),
            starts: mesh.cells.offsets.clone(),
            displacements,
            strains,
            added: (0..cells.len())
                .map(|cell| self.problem.added.get(cell) == Some(&true))
                .collect(),
            facets: sides
                .map(|(minus, plus)| [number(minus), number(plus)])
                .collect(),
            facet_points: self.left_points(state),
            reached: state.reached,
        }
    }

    fn left_points(&self, state: &State) -> Vec<Vec<LeftPoint>> {
        let mut of_facet = vec![Vec::new(); self.problem.mesh.facets.elements.len()];
        let interface = &self.discretisation.interface;
        let jumps = self.total_jumps(state);
        let seen = self.seen_jumps(state);
        for (index, point) in interface.points.iter().enumerate() {
            of_facet[point.facet as usize].push(LeftPoint {
                state: state.facet_points[index],
                jump: jumps[index],
                seen: seen[index],
            });
        }
        of_facet
    }

    /// Goes on from the end of another stage; `cells` are the numbers of the cells of this one. The
    /// last load case becomes what holds the walls that were cut, at factor 1 all of it: what was
    /// there balances what is there now under [`crate::Schedule::start`].
    ///
    /// # Panics
    /// If there is no load case.
    pub fn go_on_from(&mut self, end: &StageEnd, cells: &[u32]) {
        let start = self.problem.schedule.start();
        let zero = vec![DVec3::ZERO; self.discretisation.points.len()];
        let held = self.displacements(&zero, &start);
        let moved = self.moved_points(end, cells);
        let offsets = self.offsets(end, cells, &moved);
        let displacements: Vec<DVec3> = moved.iter().zip(&held).map(|(u, g)| *u - *g).collect();
        self.carried = Some(self.carried_facets(end, cells));
        let space = self.discretisation.space(self.problem);
        let stressed = Loads::resistance(space, &displacements, &offsets);
        let initial = self.loads.initial().iter().zip(stressed);
        let initial: Vec<DVec3> = initial.map(|(force, by)| *force + by).collect();
        self.loads = Loads::new(self.loads.cases().to_vec(), initial);
        if let Some(carried) = &mut self.carried {
            carried.displacements = displacements;
            carried.offsets = offsets;
        }
        let state = self.initial_state();
        let residual = self.residual(&zero, &self.law_tractions(&state), &start);
        let mut cases = self.loads.cases().to_vec();
        let holding = cases.last_mut().expect("a load case for what holds walls");
        holding.applied = residual.into_iter().map(|force| -force).collect();
        self.loads = Loads::new(cases, self.loads.initial().to_vec());
    }

    /// Displacement of every point at the end of a stage (m). Points that come begin where those
    /// beside them are.
    fn moved_points(&self, end: &StageEnd, cells: &[u32]) -> Vec<DVec3> {
        let mesh = &self.problem.mesh;
        let points = &self.discretisation.points;
        let mut moved: Vec<Option<DVec3>> = vec![None; points.len()];
        for (cell, &number) in cells.iter().enumerate() {
            let Some(place) = end.place(number) else {
                continue;
            };
            let slots = mesh.cells.range(cell).zip(end.starts[place] as usize..);
            for (slot, before) in slots {
                let point = points.of_cell_node[slot] as usize;
                moved[point].get_or_insert(end.displacements[before]);
            }
        }
        spread(mesh, points, moved)
    }

    fn offsets(&self, end: &StageEnd, cells: &[u32], moved: &[DVec3]) -> StrainOffsets {
        let mesh = &self.problem.mesh;
        let of_slot = &self.discretisation.points.of_cell_node;
        let mut offsets = BTreeMap::new();
        for (cell, &number) in cells.iter().enumerate() {
            let place = end.place(number);
            let slots = mesh.cells.range(cell).enumerate();
            let own = slots.map(|(local, slot)| {
                let strain = place.map(|place| end.strains[end.starts[place] as usize + local]);
                strain.unwrap_or_default() - moved[of_slot[slot] as usize]
            });
            let own: Vec<DVec3> = own.collect();
            if own.iter().any(|offset| *offset != DVec3::ZERO) {
                offsets.insert(cell as u32, own);
            }
        }
        StrainOffsets(offsets)
    }

    /// The facet points: as they were, or new ones.
    fn carried_facets(&self, end: &StageEnd, cells: &[u32]) -> Carried {
        let facets = &self.problem.mesh.facets;
        let interface = &self.discretisation.interface;
        let known: HashMap<[u32; 2], usize> = (end.facets.iter().copied()).zip(0..).collect();
        let zero = vec![DVec3::ZERO; self.discretisation.points.len()];
        let begin = interface.jumps(&zero, &self.problem.schedule.start());
        let mut taken = vec![0; facets.elements.len()];
        let mut carried = Carried {
            reached: end.reached,
            ..Carried::default()
        };
        for (point, begin) in interface.points.iter().zip(begin) {
            let facet = point.facet as usize;
            let sides = [facets.minus[facet], facets.plus[facet]].map(|cell| cells[cell as usize]);
            let own = known.get(&sides).map(|&place| &end.facet_points[place]);
            let former = own.and_then(|own| own.get(taken[facet]).copied());
            taken[facet] += 1;
            let left = former.unwrap_or(LeftPoint {
                state: FacetPointState {
                    joint: *interface.initial_walls(point),
                    jump_residual: DVec3::ZERO,
                    history: JointHistory::default(),
                },
                jump: DVec3::ZERO,
                seen: interface.initial_jump(point),
            });
            carried.jumps.push(left.jump - begin);
            carried.seen.push(left.seen - begin);
            carried.facet_points.push(left.state);
        }
        carried
    }
}
