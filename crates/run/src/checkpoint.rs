//! `resume.bin`: what a run needs to go on where it was interrupted.
//!
//! A head that names the format, an [`Identity`], [`Progress`] (both as postcard), and the XXH3 sum
//! of all that. Whether the file is whole and belongs to the run is known before anything else of
//! it is believed.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;

use kluft_io::{Fingerprint, write_atomically};
use kluft_mesh::Defect;
use kluft_solver::{RestartState, StageEnd, TransientState};
use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_128;

use crate::choice::Choice;
use crate::flow_summary::StepFlow;
use crate::measure::Measure;
use crate::page::Iterations;
use crate::summary::{FractureSummary, MeshTrial, Seconds, StepFracture, StepMeasures};

/// Its name in the folder of the results.
pub const NAME: &str = "resume.bin";
/// What every checkpoint begins with, and the number of the format.
const HEAD: &[u8] = b"kluft checkpoint 17\n";
const KIND: usize = b"kluft checkpoint ".len();
/// Bytes of the sum at the end.
const SUM: usize = 16;
/// Bytes that are summed up and written at a time.
const BUFFER: usize = 1 << 16;
/// What helps against any checkpoint that does not serve.
const AFRESH: &str = "run without --resume: it starts from the beginning";

/// The sums of the two grids of a load step.
pub type StepFiles = [Fingerprint; 2];

/// What a run is made of; it can only be resumed with the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program.
    pub version: String,
    /// The text of the scene.
    pub scene: Fingerprint,
    /// The text of the geometry, if the scene names one.
    pub geometry: Option<Fingerprint>,
    /// The bytes of the files of values that the scene names, in its order.
    pub values: Vec<Fingerprint>,
    /// The bytes of the mesh file.
    pub mesh: Fingerprint,
    /// Number of processes; results depend on it in their last digits.
    pub ranks: u32,
}

/// What is finished, and how to go on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Progress<'a> {
    /// The linear solver.
    pub choice: Choice,
    /// The finished load steps.
    pub steps: Vec<StepMeasures>,
    /// Their flows, if there is a fluid.
    pub flows: Vec<Option<StepFlow>>,
    /// Their grids, by which they are known again.
    pub files: Vec<StepFiles>,
    /// Their fractures, as `summary.json` has them of every step.
    pub step_fractures: Vec<Vec<(String, StepFracture)>>,
    /// The fractures after the last of them.
    pub fractures: Vec<(String, FractureSummary)>,
    /// Estimated error of the stress after the last of them.
    pub stress_error: f64,
    /// The text of the history of all of them.
    pub history: String,
    /// The text of their probes.
    pub probes: String,
    /// The measures after the last of them.
    pub measures: Vec<Measure>,
    /// How Newton's method went, for the page.
    pub iterations: Iterations,
    /// Where the time went so far.
    pub seconds: Seconds,
    /// Largest resident memory so far (bytes).
    pub peak_memory_bytes: u64,
    /// Where its mesh came from, and what was decided.
    pub origins: Origins,
    /// What the present stage of the body began with, if it is not the first.
    pub stage: Option<Cow<'a, StageEnd>>,
    /// Where the solver stands; none after the last load step, and in rigid rock.
    pub restart: Option<RestartState<'a>>,
    /// Where the flow in rigid rock stands; none after the last load step.
    pub flow_restart: Option<FlowRestart>,
}

/// What is told of a run once, at its beginning or on the way.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Origins {
    /// The meshes on the way to the last one.
    pub meshes: Vec<MeshTrial>,
    /// What the program decided, in words.
    pub decisions: Vec<String>,
    /// Version of gmsh, if it made the mesh.
    pub gmsh: Option<String>,
}

/// How a flow in rigid rock goes on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FlowRestart {
    /// What the next load step starts from, if the fluid is stored.
    pub state: Option<TransientState>,
    /// What was warned of.
    pub warnings: Vec<String>,
}

/// A writer that sums up what goes through it, and keeps the error that postcard does not pass on.
struct Summing<W> {
    inner: W,
    sum: XxHash3_128,
    error: Option<io::Error>,
}

impl<W: Write> Write for Summing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes);
        let count = self.known(written)?;
        self.sum.write(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.inner.flush();
        self.known(flushed)
    }
}

impl<W> Summing<W> {
    /// The same, its error kept.
    fn known<T>(&mut self, done: io::Result<T>) -> io::Result<T> {
        done.map_err(|error| {
            let kind = error.kind();
            self.error = Some(error);
            kind.into()
        })
    }
}

impl<W: Write> Summing<W> {
    /// Behind a buffer: postcard writes number by number, and a sum of few bytes at a time takes
    /// long.
    fn buffered(inner: W) -> BufWriter<Self> {
        let summing = Self {
            inner,
            sum: XxHash3_128::new(),
            error: None,
        };
        BufWriter::with_capacity(BUFFER, summing)
    }
}

/// Writes a checkpoint, whole or not at all.
///
/// # Errors
/// If the file cannot be written.
pub fn write(path: &Path, identity: &Identity, progress: &Progress<'_>) -> Result<(), Defect> {
    write_atomically(path, |out| {
        let mut out = Summing::buffered(out);
        out.write_all(HEAD)?;
        encode(identity, &mut out)?;
        encode(progress, &mut out)?;
        let summed = out.get_mut();
        let sum = summed.sum.finish_128();
        summed.inner.write_all(&sum.to_le_bytes())
    })
}

fn encode<W: Write>(value: &impl Serialize, out: &mut BufWriter<Summing<W>>) -> io::Result<()> {
    let encoded = postcard::to_io(value, &mut *out)
        .map(drop)
        .map_err(io::Error::other);
    let written = encoded.and_then(|()| out.flush());
    written.map_err(|error| out.get_mut().error.take().unwrap_or(error))
}

/// Whether a file begins as checkpoints of any format do.
pub fn is_checkpoint(path: &Path) -> bool {
    let mut head = [0; KIND];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut head));
    read.is_ok() && head == HEAD[..KIND]
}

/// The bytes of a checkpoint that is whole.
pub struct Stored {
    bytes: Vec<u8>,
    /// Where the progress begins.
    start: usize,
    /// What it belongs to.
    pub identity: Identity,
}

/// Reads a checkpoint; none if there is no such file.
///
/// # Errors
/// If it cannot be read, is damaged, or of another format.
pub fn read(path: &Path) -> Result<Option<Stored>, Defect> {
    let place = path.display().to_string();
    let mut bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => {
            let problem = format!("the checkpoint cannot be read: {error}");
            let remedy = format!("check the permissions, or {AFRESH}");
            return Err(Defect::new(place, problem, remedy));
        }
    };
    let refused = |problem: &str| Defect::new(&place, problem, AFRESH);
    let damaged = || refused("the checkpoint is damaged");
    if bytes.starts_with(&HEAD[..KIND]) && !bytes.starts_with(HEAD) && is_whole(&bytes) {
        return Err(refused(
            "the checkpoint is of another version of the program",
        ));
    }
    if !bytes.starts_with(HEAD) || !is_whole(&bytes) {
        return Err(damaged());
    }
    bytes.truncate(bytes.len() - SUM);
    let (identity, rest) =
        postcard::take_from_bytes::<Identity>(&bytes[HEAD.len()..]).map_err(|_| damaged())?;
    let start = bytes.len() - rest.len();
    Ok(Some(Stored {
        bytes,
        start,
        identity,
    }))
}

/// Whether the sum at the end is that of all before it.
fn is_whole(bytes: &[u8]) -> bool {
    let Some(length) = bytes.len().checked_sub(SUM) else {
        return false;
    };
    let (content, sum) = bytes.split_at(length);
    sum == XxHash3_128::oneshot(content).to_le_bytes()
}

impl Stored {
    /// What it holds.
    ///
    /// # Errors
    /// If that cannot be told, although the file is whole.
    pub fn progress(&self, path: &Path) -> Result<Progress<'static>, Defect> {
        postcard::from_bytes(&self.bytes[self.start..]).map_err(|_| other_build(path))
    }
}

/// A checkpoint whose content makes no sense to this program.
pub fn other_build(path: &Path) -> Defect {
    let problem = "the checkpoint is of another build of the program";
    Defect::new(path.display().to_string(), problem, AFRESH)
}

impl Identity {
    /// What keeps a run of `self` from going on where one of `former` stopped; the mesh is told by
    /// [`other_mesh`].
    pub fn differences(&self, former: &Self, scene: &Path, geometry: Option<&Path>) -> Vec<Defect> {
        let changed = |path: &Path, what: &str| {
            let problem = format!("the {what} has changed since the run was interrupted");
            let remedy = format!("undo the change, or {AFRESH}");
            Defect::new(path.display().to_string(), problem, remedy)
        };
        let version = (self.version != former.version).then(|| {
            let problem = format!(
                "the run was interrupted in version {} of the program, and this is {}",
                former.version, self.version
            );
            let remedy = format!("use that version, or {AFRESH}");
            Defect::new(NAME, problem, remedy)
        });
        let ranks = (self.ranks != former.ranks).then(|| {
            let problem = format!(
                "the run was interrupted on {} ranks, and there are {} now",
                former.ranks, self.ranks
            );
            let remedy = format!("give it as many ranks as before, or {AFRESH}");
            Defect::new(NAME, problem, remedy)
        });
        let scene = (self.scene != former.scene).then(|| changed(scene, "scene"));
        let geometry = geometry.filter(|_| self.geometry != former.geometry);
        let geometry = geometry.map(|path| changed(path, "geometry"));
        let values = self.scene == former.scene && self.values != former.values;
        let values = values.then(|| {
            let problem = "a file of values that the scene names has changed since the run was \
                           interrupted";
            Defect::new(NAME, problem, format!("undo the change, or {AFRESH}"))
        });
        let scene = scene.into_iter().chain(geometry);
        version
            .into_iter()
            .chain(ranks)
            .chain(scene)
            .chain(values)
            .collect()
    }
}

/// A mesh that is not the one of the interrupted run.
pub fn other_mesh(path: &Path, is_made: bool) -> Defect {
    let (problem, remedy) = if is_made {
        (
            "gmsh now makes another mesh than that of the interrupted run",
            "use the same gmsh and the same files that the geometry includes, or put the former mesh.msh back",
        )
    } else {
        (
            "the mesh has changed since the run was interrupted",
            "put the former mesh back",
        )
    };
    let remedy = format!("{remedy}; or {AFRESH}");
    Defect::new(path.display().to_string(), problem, remedy)
}

#[cfg(test)]
mod tests {
    use kluft_io::fingerprint;

    use super::*;

    fn identity() -> Identity {
        Identity {
            version: "1.2.3".into(),
            scene: fingerprint("scene"),
            geometry: Some(1 << 127),
            values: vec![3],
            mesh: 7,
            ranks: 2,
        }
    }

    fn progress() -> Progress<'static> {
        Progress {
            choice: Choice {
                solver: "direct".into(),
                why: "why".into(),
                ..Choice::default()
            },
            steps: Vec::new(),
            flows: vec![None],
            files: Vec::new(),
            step_fractures: Vec::new(),
            fractures: Vec::new(),
            history: String::new(),
            probes: String::new(),
            stress_error: 0.0,
            iterations: Iterations::default(),
            measures: Vec::new(),
            seconds: Seconds::default(),
            peak_memory_bytes: 5,
            origins: Origins::default(),
            stage: None,
            restart: None,
            flow_restart: None,
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(NAME);
        assert!(read(&path).expect("no defect").is_none());
        write(&path, &identity(), &progress()).expect("written");
        let stored = read(&path).expect("no defect").expect("a checkpoint");
        assert_eq!(stored.identity, identity());
        let found = stored.progress(&path).expect("progress");
        assert_eq!(
            (found.choice, found.peak_memory_bytes),
            (progress().choice, 5)
        );
    }

    #[test]
    fn any_changed_or_missing_byte_is_noticed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(NAME);
        write(&path, &identity(), &progress()).expect("written");
        let whole = std::fs::read(&path).expect("bytes");
        for at in 0..whole.len() {
            let mut changed = whole.clone();
            changed[at] ^= 0x10;
            for bytes in [&changed[..], &whole[..at]] {
                std::fs::write(&path, bytes).expect("written");
                let defect = read(&path).err().expect("a defect");
                assert!(defect.problem.contains("damaged"), "{defect}");
            }
        }
    }

    #[test]
    fn another_format_is_told_from_a_damaged_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(NAME);
        let mut bytes = b"kluft checkpoint 977\nwhatever that means".to_vec();
        let sum = XxHash3_128::oneshot(&bytes);
        bytes.extend(sum.to_le_bytes());
        std::fs::write(&path, bytes).expect("written");
        let defect = read(&path).err().expect("a defect");
        assert!(defect.problem.contains("another version"), "{defect}");
        assert!(defect.remedy.contains("without --resume"), "{defect}");
    }

    #[test]
    fn a_disk_that_is_full_is_said_in_its_own_words() {
        // What fits a buffer behind is refused when that is emptied.
        struct Full {
            room: usize,
        }
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                match bytes.len() <= self.room {
                    true => Ok(bytes.len()),
                    false => Err(io::ErrorKind::StorageFull.into()),
                }
            }
            fn flush(&mut self) -> io::Result<()> {
                Err(io::ErrorKind::StorageFull.into())
            }
        }
        for room in [0, BUFFER] {
            let mut out = Summing::buffered(Full { room });
            let error = encode(&identity(), &mut out).expect_err("full");
            assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        }
    }

    #[test]
    fn every_difference_is_named() {
        let mut other = identity();
        let compare = |other: &Identity| {
            let (scene, geometry) = (Path::new("a/scene.toml"), Path::new("a/b.geo"));
            identity().differences(other, scene, Some(geometry))
        };
        assert_eq!(compare(&other), Vec::new());
        other.values = vec![4];
        let defects = compare(&other);
        assert!(defects[0].problem.contains("file of values"), "{defects:?}");
        (other.values, other.ranks) = (vec![3], 3);
        let defects = compare(&other);
        assert!(
            defects[0].problem.contains("on 3 ranks, and there are 2"),
            "{defects:?}"
        );
        other.ranks = 2;
        other.version = "1.2.2".into();
        other.scene ^= 1;
        other.geometry = None;
        let defects = compare(&other);
        let said: Vec<String> = defects.iter().map(ToString::to_string).collect();
        assert_eq!(said.len(), 3, "{said:?}");
        assert!(said[0].contains("version 1.2.2") && said[0].contains("this is 1.2.3"));
        assert!(
            said[1].starts_with("a/scene.toml: the scene has changed"),
            "{}",
            said[1]
        );
        assert!(
            said[2].starts_with("a/b.geo: the geometry has changed"),
            "{}",
            said[2]
        );
    }
}
