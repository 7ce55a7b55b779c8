//! Rock that stays prepared between load steps, on a thread of its own.

use std::sync::Mutex;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use kluft_io::{GmshOptions, Grid};
use kluft_run::{
    Advance, Interruption, MeshInput, PreparedRock, Request, StepResult, Summary,
    with_prepared_rock,
};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{CellArrays, GridArrays};
use crate::asked::threads;
use crate::errors::input_error;
use crate::follow::{Bell, Follower, Told, sides};
use crate::mesh::Mesh;
use crate::program::{Own, gmsh_options};
use crate::results::Results;
use crate::scene::Scene;

/// What is known of the rock once it is prepared.
struct Ready {
    acting: Vec<String>,
    fractures: Vec<String>,
    points: Grid,
    summary: Summary,
}

/// A load step that was solved, with the numbers so far.
struct Solved {
    result: StepResult,
    summary: Summary,
    history: String,
}

/// What the thread answers; a failure comes with the share of the step that was solved.
enum Reply {
    Ready(Box<Ready>),
    Solved(Box<Solved>),
    Failed(Interruption, f64),
}

/// The thread, and the ways to it.
struct Session {
    commands: Sender<Advance>,
    replies: Receiver<Reply>,
    follower: Follower,
    thread: JoinHandle<()>,
}

/// Rock that is prepared.
#[pyclass(frozen)]
pub struct Prepared {
    session: Mutex<Option<Session>>,
    acting: Vec<String>,
    fractures: Vec<String>,
    points: GridArrays,
    results: Py<Results>,
}

/// How a step ended (`solved`, `stopped`, `not converged`), why, the share of it that was solved,
/// and what a signal or the callback raised.
type Ended = (&'static str, String, f64, Option<Py<PyAny>>);

#[pymethods]
impl Prepared {
    /// Prepares the rock of a scene.
    #[new]
    fn new(
        py: Python<'_>,
        scene: Py<Scene>,
        mesh: Option<Py<Mesh>>,
        asked: (Option<usize>, Own),
        callback: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut session = Session::begin(scene, mesh, asked, callback.is_some());
        session.follower.follow(py, callback.as_ref())?;
        match session.reply(py)? {
            Reply::Ready(ready) => {
                let results = Results::of(py, ready.summary, String::new(), Vec::new());
                Ok(Self {
                    session: Mutex::new(Some(session)),
                    acting: ready.acting,
                    fractures: ready.fractures,
                    points: GridArrays::of(py, ready.points, None),
                    results: Py::new(py, results)?,
                })
            }
            Reply::Failed(Interruption::Defects(defects), _) => Err(input_error(py, defects)),
            Reply::Failed(Interruption::NotConverged(why), _) => Err(PyRuntimeError::new_err(why)),
            Reply::Failed(Interruption::Stopped, _) | Reply::Solved(_) => Err(broken_off()),
        }
    }

    /// What acts, in the order of the factors.
    #[getter]
    fn acting(&self) -> Vec<String> {
        self.acting.clone()
    }

    /// The fractures, in the order of the field `fracture`.
    #[getter]
    fn fractures(&self) -> Vec<String> {
        self.fractures.clone()
    }

    /// The facets, each with points of its own.
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.points.dict(py)
    }

    /// Connectivity, ends and types of the facets.
    fn cells<'py>(&self, py: Python<'py>) -> CellArrays<'py> {
        self.points.cells(py)
    }

    /// The results of the steps so far.
    #[getter]
    fn results(&self, py: Python<'_>) -> Py<Results> {
        self.results.clone_ref(py)
    }

    /// Solves a further load step: its time, the factors, pressures at the points, a scene whose
    /// laws hold from now on, whether the rock is wanted.
    fn advance(
        &self,
        py: Python<'_>,
        load: (Option<f64>, Vec<f64>),
        pressures: Option<PyReadonlyArray1<'_, f64>>,
        changes: (Option<Py<Scene>>, bool),
        callback: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Ended> {
        let pressures = pressures.map(|pressures| pressures.as_slice().map(<[f64]>::to_vec));
        let (laws, with_rock) = changes;
        let asked = Advance {
            time: load.0,
            factors: load.1,
            pressures: pressures.transpose()?,
            laws: laws.map(|scene| scene.get().scene.laws(&self.fractures)),
            with_rock,
        };
        let mut held = self.session.try_lock().map_err(|_| busy())?;
        let session = held.as_mut().ok_or_else(closed)?;
        session.follower.listen(callback.is_some());
        session.commands.send(asked).map_err(|_| broken_off())?;
        let followed = session.follower.follow(py, callback.as_ref());
        let reply = session.reply(py)?;
        let raised = followed.err().map(|error| error.into_value(py).into_any());
        match reply {
            Reply::Solved(solved) => {
                let mut results = self.results.borrow_mut(py);
                results.add(py, solved.result, solved.summary, solved.history);
                Ok(("solved", String::new(), 1.0, raised))
            }
            Reply::Failed(Interruption::Defects(defects), _) => Err(input_error(py, defects)),
            Reply::Failed(Interruption::NotConverged(why), completed) => {
                Ok(("not converged", why, completed, raised))
            }
            Reply::Failed(Interruption::Stopped, completed) => {
                Ok(("stopped", String::new(), completed, raised))
            }
            Reply::Ready(_) => Err(broken_off()),
        }
    }

    /// Gives back the memory of the rock; results stay.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let session = self.session.try_lock().map_err(|_| busy())?.take();
        let Some(Session {
            commands, thread, ..
        }) = session
        else {
            return Ok(());
        };
        drop(commands);
        py.detach(|| thread.join()).map_err(|_| broken_off())
    }
}

fn busy() -> PyErr {
    PyRuntimeError::new_err("another thread is solving a step of this run")
}

fn closed() -> PyErr {
    PyRuntimeError::new_err("the run is closed: its rock is no longer in memory")
}

fn broken_off() -> PyErr {
    PyRuntimeError::new_err("the run broke off: report this as an error of the program")
}

impl Session {
    fn begin(
        scene: Py<Scene>,
        mesh: Option<Py<Mesh>>,
        (count, own): (Option<usize>, Own),
        is_heard: bool,
    ) -> Self {
        let mesh = mesh.map_or(MeshInput::OfScene, |mesh| {
            MeshInput::Draft(Box::new(mesh.get().draft.clone()))
        });
        let scene = scene.get().scene.clone();
        let (told, follower) = sides(is_heard);
        let (commands, asked) = channel();
        let (answers, replies) = channel();
        let given = (scene, mesh, count, gmsh_options(own, told.stop()));
        let thread = std::thread::spawn(move || work(given, told, asked, answers));
        Self {
            commands,
            replies,
            follower,
            thread,
        }
    }

    /// What the thread answered.
    fn reply(&self, py: Python<'_>) -> PyResult<Reply> {
        // The bell has rung: it is there, or will never be.
        py.check_signals()?;
        self.replies.try_recv().map_err(|_| broken_off())
    }
}

/// What the thread does: prepares the rock, then solves steps until nobody asks any more.
fn work(
    (scene, mesh, count, gmsh): (kluft_scene::Scene, MeshInput, Option<usize>, GmshOptions),
    mut told: Told,
    asked: Receiver<Advance>,
    answers: Sender<Reply>,
) {
    let bell = told.bell();
    let prepared = threads(count).map_err(|defect| vec![defect].into());
    let prepared = prepared.and_then(|pool| {
        let request = Request {
            keep_results: false,
            gmsh,
            ..Request::in_memory(&scene, mesh, &pool)
        };
        let serve = |rock: &mut PreparedRock<'_, '_, '_>| serve(rock, asked, (&answers, &bell));
        with_prepared_rock(request, &mut told, serve)
    });
    if let Err(why) = prepared {
        // Who has gone need not be told.
        let _ = answers.send(Reply::Failed(why, 0.0));
        bell.ring();
    }
}

fn serve(
    rock: &mut PreparedRock<'_, '_, '_>,
    asked: Receiver<Advance>,
    (answers, bell): (&Sender<Reply>, &Bell),
) {
    let mut reply = Reply::Ready(Box::new(Ready {
        acting: rock.acting().names().to_vec(),
        fractures: rock.problem().mesh.fractures.clone(),
        points: rock.fracture_points(),
        summary: rock.summary().clone(),
    }));
    loop {
        if answers.send(reply).is_err() {
            return;
        }
        bell.ring();
        let Ok(next) = asked.recv() else {
            return;
        };
        reply = match rock.advance(&next) {
            Ok(result) => Reply::Solved(Box::new(Solved {
                result,
                summary: rock.summary().clone(),
                history: rock.history().to_owned(),
            })),
            Err(why) => Reply::Failed(why, rock.completed()),
        };
    }
}
