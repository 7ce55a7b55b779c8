//! One number by which runs are compared.

use serde::{Deserialize, Serialize};

/// One number by which runs are compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// What is measured.
    pub name: String,
    /// The fracture; none for the whole body.
    pub fracture: Option<String>,
    /// Its value, if it is one number.
    pub value: Option<f64>,
    /// Its value in closed form.
    pub exact: Option<f64>,
    /// Error as a share of the closed form; of a field, of its norm.
    pub error: Option<f64>,
}
