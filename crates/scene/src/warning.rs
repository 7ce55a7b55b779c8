//! What is possible but hardly meant: the run goes on and says so, unless the scene silences it.

use crate::scene::Scene;

/// What a run may warn of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// A value of the scene that is hardly meant.
    Values,
    /// A body of a size that is out of proportion.
    BodySize,
    /// Walls that are further apart than their facets are long.
    WideApertures,
    /// Displacements that are not small beside the body.
    LargeDisplacements,
    /// A history whose factor is 0 wherever a load step ends.
    IdleHistories,
    /// An initial stress that the loads do not balance.
    InitialStress,
    /// A surface inside the rock without a name, which no section serves.
    UnnamedSurfaces,
    /// Walls that have gone through each other.
    OverlappingWalls,
    /// A state that the loads do not determine.
    NotUnique,
    /// A path of the loads that no division of a step resolves.
    UnresolvedPath,
    /// Time steps of a flow that are too long for the accuracy asked for, however they are divided.
    LongTimeSteps,
    /// Times or a viscosity that make no sense beside the apertures and sizes of a scene.
    FluidTimes,
    /// Fractures between which fluid passes through a single node only.
    PointContacts,
}

impl Doubt {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Values,
        Self::BodySize,
        Self::WideApertures,
        Self::LargeDisplacements,
        Self::IdleHistories,
        Self::InitialStress,
        Self::UnnamedSurfaces,
        Self::OverlappingWalls,
        Self::NotUnique,
        Self::UnresolvedPath,
        Self::LongTimeSteps,
        Self::FluidTimes,
        Self::PointContacts,
    ];

    /// Its name under `silence`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Values => "values",
            Self::BodySize => "body_size",
            Self::WideApertures => "wide_apertures",
            Self::LargeDisplacements => "large_displacements",
            Self::IdleHistories => "idle_histories",
            Self::InitialStress => "initial_stress",
            Self::UnnamedSurfaces => "unnamed_surfaces",
            Self::OverlappingWalls => "overlapping_walls",
            Self::NotUnique => "not_unique",
            Self::UnresolvedPath => "unresolved_path",
            Self::LongTimeSteps => "long_time_steps",
            Self::FluidTimes => "fluid_times",
            Self::PointContacts => "point_contacts",
        }
    }
}

impl Scene {
    /// A warning with the key that silences it; none if the scene does.
    pub fn warning(&self, doubt: Doubt, text: &str) -> Option<String> {
        let name = doubt.name();
        let is_silenced = self.silenced.contains(&name);
        (!is_silenced).then(|| format!("{text} ([warnings] silence = [\"{name}\"] if it is meant)"))
    }
}

#[cfg(test)]
mod tests {
    use super::Doubt;

    #[test]
    fn every_doubt_can_be_silenced_by_its_name() {
        assert_eq!(Doubt::ALL.map(Doubt::name), kluft_keys::scene::WARNINGS);
    }
}
