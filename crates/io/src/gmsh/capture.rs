//! What a program prints, kept within bounds: the beginning and the end.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read};
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes that are kept of the beginning, and as many of the end.
const KEPT: usize = 256 << 10;

/// What has been read of a stream so far.
#[derive(Debug, Default)]
struct Kept {
    head: Vec<u8>,
    tail: VecDeque<u8>,
    is_cut: bool,
}

impl Kept {
    fn take(&mut self, mut bytes: &[u8]) {
        let room = (KEPT - self.head.len()).min(bytes.len());
        self.head.extend_from_slice(&bytes[..room]);
        bytes = &bytes[room..];
        self.tail.extend(bytes);
        let over = self.tail.len().saturating_sub(KEPT);
        self.tail.drain(..over);
        self.is_cut |= over > 0;
    }

    fn text(&self) -> String {
        let mut bytes = self.head.clone();
        if self.is_cut {
            bytes.extend_from_slice(b"\n[...]\n");
        }
        bytes.extend(&self.tail);
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

/// A stream that a thread of its own reads to its end.
pub(super) struct Capture(Arc<Mutex<Kept>>);

impl Capture {
    /// Begins to read; `at_end` is called when there is no more.
    pub(super) fn begin(
        mut stream: impl Read + Send + 'static,
        at_end: impl FnOnce() + Send + 'static,
    ) -> Self {
        let kept = Arc::new(Mutex::new(Kept::default()));
        let shared = Arc::clone(&kept);
        std::thread::spawn(move || {
            let mut buffer = [0; 1 << 14];
            loop {
                match stream.read(&mut buffer) {
                    Err(error) if error.kind() == ErrorKind::Interrupted => {}
                    // A stream that breaks has ended.
                    Ok(0) | Err(_) => break,
                    Ok(count) => {
                        let mut kept = shared.lock().unwrap_or_else(PoisonError::into_inner);
                        kept.take(&buffer[..count]);
                    }
                }
            }
            at_end();
        });
        Self(kept)
    }

    /// What has come so far.
    pub(super) fn text(&self) -> String {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).text()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_stream_keeps_its_beginning_and_its_end() {
        let mut kept = Kept::default();
        kept.take(b"first\n");
        for _ in 0..5 * KEPT / 16 {
            kept.take(b"nothing to keep\n");
        }
        kept.take(b"last");
        let text = kept.text();
        assert!(text.starts_with("first\n") && text.ends_with("last"));
        assert!(text.contains("[...]") && text.len() < 2 * KEPT + 20);
    }

    #[test]
    fn a_short_stream_is_kept_whole() {
        let (done, ended) = std::sync::mpsc::channel();
        let capture = Capture::begin(&b"all of it"[..], move || {
            let _ = done.send(());
        });
        ended.recv().expect("the end");
        assert_eq!(capture.text(), "all of it");
    }
}
