//! A run works on threads of its own; the thread that called follows it.
//!
//! The thread that called is the only one that signals reach, and the one on which Python code
//! runs: it waits for events, looks for signals and hands events on. The run waits for the answer
//! to an iteration, so that it stops exactly there.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::time::Duration;

use kluft_run::{Observer, Stage, StepStart};
use kluft_solver::Iteration;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};

/// How long signals wait.
const LOOK: Duration = Duration::from_millis(50);

/// What is told of a run.
pub enum Event {
    /// A stage begins.
    StageBegins(Stage),
    /// A stage has ended.
    StageEnds(Stage, Duration),
    /// A fact or a decision.
    Note(String, String),
    /// A load step begins: number, number of all, what it is.
    StepBegins(usize, usize, String),
    /// An iteration has ended; it waits for an answer.
    Iteration(usize, Iteration),
    /// What was asked for is done.
    Done,
}

/// The side of the run.
pub struct Told {
    events: Sender<Event>,
    answers: Receiver<()>,
    stop: Arc<AtomicBool>,
    /// Whether anybody wants to know.
    is_heard: Arc<AtomicBool>,
}

/// Says that what was asked for is done.
pub struct Bell(Sender<Event>);

impl Bell {
    /// Says so; nobody may be there to hear it.
    pub fn ring(&self) {
        let _ = self.0.send(Event::Done);
    }
}

/// The side of the thread that called.
pub struct Follower {
    events: Option<Receiver<Event>>,
    answers: SyncSender<()>,
    stop: Arc<AtomicBool>,
    is_heard: Arc<AtomicBool>,
}

/// Both sides; without a callback only signals are looked for.
pub fn sides(is_heard: bool) -> (Told, Follower) {
    let (events, heard) = channel();
    let (answers, answered) = sync_channel(1);
    let stop = Arc::new(AtomicBool::new(false));
    let is_heard = Arc::new(AtomicBool::new(is_heard));
    let told = Told {
        events,
        answers: answered,
        stop: Arc::clone(&stop),
        is_heard: Arc::clone(&is_heard),
    };
    let follower = Follower {
        events: Some(heard),
        answers,
        stop,
        is_heard,
    };
    (told, follower)
}

impl Told {
    /// True once the run is to stop.
    pub fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// What says that all is done.
    pub fn bell(&self) -> Bell {
        Bell(self.events.clone())
    }

    fn is_heard(&self) -> bool {
        self.is_heard.load(Ordering::Relaxed)
    }

    fn send(&self, event: Event) {
        // Where nobody listens any more, nobody need be told.
        let _ = self.events.send(event);
    }
}

impl Observer for Told {
    fn stage_begins(&mut self, stage: Stage) {
        if self.is_heard() {
            self.send(Event::StageBegins(stage));
        }
    }

    fn stage_ends(&mut self, stage: Stage, took: Duration) {
        if self.is_heard() {
            self.send(Event::StageEnds(stage, took));
        }
    }

    fn note(&mut self, kind: &str, text: &str) {
        if self.is_heard() {
            self.send(Event::Note(kind.to_owned(), text.to_owned()));
        }
    }

    fn step_begins(&mut self, step: StepStart<'_>) {
        if self.is_heard() {
            let what = step.what.to_owned();
            self.send(Event::StepBegins(step.number, step.count, what));
        }
    }

    fn iteration(&mut self, number: usize, iteration: &Iteration) -> ControlFlow<()> {
        if self.is_heard() {
            self.send(Event::Iteration(number, *iteration));
            // Where nobody answers any more, nobody stops it either.
            let _ = self.answers.recv();
        }
        self.goes_on()
    }

    fn goes_on(&mut self) -> ControlFlow<()> {
        match self.stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

impl Follower {
    /// Whether there is a callback from now on.
    pub fn listen(&self, is_heard: bool) {
        self.is_heard.store(is_heard, Ordering::Relaxed);
    }

    /// Follows until what was asked for is done or the other side is gone. `callback` gets each
    /// event as a dictionary; `False` stops the run after the iteration.
    ///
    /// # Errors
    /// What a signal or the callback raised; the run has stopped by then.
    pub fn follow(&mut self, py: Python<'_>, callback: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        self.stop.store(false, Ordering::Relaxed);
        let mut raised = None;
        while let Some(events) = self.events.take() {
            let (events, event) = py.detach(move || {
                let event = events.recv_timeout(LOOK);
                (events, event)
            });
            self.events = Some(events);
            let heard = match event {
                Ok(Event::Done) | Err(RecvTimeoutError::Disconnected) => break,
                Ok(event) => self.tell(py, callback, event),
                Err(RecvTimeoutError::Timeout) => Ok(()),
            };
            if let Err(error) = heard.and_then(|()| py.check_signals()) {
                self.stop.store(true, Ordering::Relaxed);
                raised.get_or_insert(error);
            }
        }
        raised.map_or(Ok(()), Err)
    }

    fn tell(
        &self,
        py: Python<'_>,
        callback: Option<&Bound<'_, PyAny>>,
        event: Event,
    ) -> PyResult<()> {
        let waits = matches!(event, Event::Iteration(..));
        let answer = callback.map(|callback| callback.call1((dictionary(py, &event)?,)));
        let is_refused = |answer: &Bound<'_, PyAny>| answer.is(PyBool::new(py, false));
        let told = match answer {
            Some(Ok(answer)) if is_refused(&answer) => {
                self.stop.store(true, Ordering::Relaxed);
                Ok(())
            }
            Some(Err(error)) => {
                self.stop.store(true, Ordering::Relaxed);
                Err(error)
            }
            _ => Ok(()),
        };
        if waits {
            // The run may have ended for want of memory.
            let _ = self.answers.send(());
        }
        told
    }
}

fn dictionary<'py>(py: Python<'py>, event: &Event) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    match event {
        Event::StageBegins(stage) => {
            dict.set_item("event", "stage begins")?;
            dict.set_item("stage", stage.name())?;
        }
        Event::StageEnds(stage, took) => {
            dict.set_item("event", "stage ends")?;
            dict.set_item("stage", stage.name())?;
            dict.set_item("seconds", took.as_secs_f64())?;
        }
        Event::Note(kind, text) => {
            dict.set_item("event", "note")?;
            dict.set_item("kind", kind)?;
            dict.set_item("text", text)?;
        }
        Event::StepBegins(number, count, what) => {
            dict.set_item("event", "step begins")?;
            dict.set_item("step", number)?;
            dict.set_item("steps", count)?;
            dict.set_item("what", what)?;
        }
        Event::Iteration(number, iteration) => {
            dict.set_item("event", "iteration")?;
            dict.set_item("iteration", number)?;
            dict.set_item("force_residual", iteration.force_residual)?;
            dict.set_item("increment", iteration.increment)?;
            dict.set_item("closure_error", iteration.closure_error)?;
            dict.set_item("smallest_aperture", iteration.smallest_aperture)?;
            dict.set_item("linear_iterations", iteration.linear_iterations)?;
        }
        Event::Done => dict.set_item("event", "done")?,
    }
    Ok(dict)
}
