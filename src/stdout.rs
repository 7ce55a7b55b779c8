//! Results on the standard output stream.

use std::io::{ErrorKind, Write};

use kluft_mesh::Defect;

use crate::failure::Failure;

/// Prints a text that is the result of a command; a closed pipe (`| head`) ends it quietly.
///
/// # Errors
/// [`Failure::Machine`] if the text cannot be written.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let problem = format!("the result cannot be written: {error}");
            let remedy = "free some space, or send the output elsewhere";
            let defect = Defect::new("standard output", problem, remedy);
            Err(Failure::Machine(vec![defect]))
        }
        _ => Ok(()),
    }
}
