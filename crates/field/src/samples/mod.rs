//! Values between samples.

mod between;
mod frame;
mod grid;
mod plane;
mod read;
mod sample;

pub use between::Samples;
pub use read::SampleFile;
pub use sample::Method;
