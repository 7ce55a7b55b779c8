//! Values that vary, against closed forms.

use std::sync::Arc;

use glam::DVec3;
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_solver::{
    Field, InitialStress, LawParameter, LoadField, Problem, Support, VaryingLaw, VaryingLoad,
    VaryingPressure,
};
use kluft_verification::scenes;
