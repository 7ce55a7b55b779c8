//! The one table of keys: every key of a scene, a network description, a list of fractures and a
//! study.
//!
//! A [`Document`] is a tree of [`KeySection`]s of [`Key`]s. From it come what the reader checks and
//! suggests, the units in which quantities may be written ([`Dimension`], [`read_quantity`]), the
//! JSON Schema for editors ([`schema`]), what `kluft explain` says ([`explain`], [`overview`]), the
//! reference pages ([`page`]) and the classes of the Python package ([`python`]).

mod dimension;
mod document;
mod explain;
mod head;
mod names;
pub mod network;
mod page;
mod plausible;
mod python;
mod range;
pub mod scene;
mod schema;
mod table;
mod units;

pub use dimension::Dimension;
pub use document::Document;
pub use explain::{explain, overview};
pub use head::{key_text, quoted, section_head};
pub use names::nearest;
pub use page::page;
pub use plausible::Plausible;
pub use python::python;
pub use range::Range;
pub use schema::schema;
pub use table::{Key, KeySection, Kind, Need, Quantity};
pub use units::{Unreadable, read_quantity};
