//! Pages that need no other file, and pictures of fractures on them.
//!
//! A [`Page`] is text, tables, charts and pictures in one HTML file; a [`Surface`] is what of a
//! grid is drawn. A picture is made point by point with a depth for each, so that fractures that
//! cross each other are right, and its size does not depend on their number of facets.

mod colours;
mod page;
mod picture;
mod raster;
mod scale;
mod surface;
mod text;
mod view;

pub use page::{Page, Table};
pub use picture::{Frame, Picture};
pub use scale::{prefixed, quantity};
pub use surface::Surface;
