//! Meshes kept under a sum of all that they are made of, for whoever asks for the same again.
//!
//! Each mesh has a folder of its own with [`MESH`] and [`RECORD`], which gets its name when both
//! are whole. What has not been asked for longest goes when all together outgrow [`LARGEST`].

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

use crate::fingerprint::{Fingerprint, fingerprint_of};

const MESH: &str = "mesh.msh";
const RECORD: &str = "record.json";
/// Of all meshes together (bytes).
const LARGEST: u64 = 8 << 30;
/// Begins the name of a folder until what it keeps is whole.
const UNFINISHED: &str = ".unfinished-";
/// No mesh takes longer to be copied.
const LONGEST_COPY: Duration = Duration::from_secs(24 * 3600);

/// A folder of meshes that gmsh has made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshCache {
    folder: PathBuf,
    /// Whether meshes that are there are made again.
    makes_again: bool,
}

/// What is known of a mesh beside itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    /// Sum of the mesh file.
    pub(super) sum: String,
    /// How long gmsh took (s).
    pub(super) seconds: f64,
    /// What gmsh warned of.
    pub(super) warnings: Vec<String>,
    /// The version of gmsh, if it said one.
    #[serde(default)]
    pub(super) version: Option<String>,
}

impl MeshCache {
    /// Meshes in this folder, which is made when the first is kept.
    pub fn at(folder: PathBuf) -> Self {
        Self {
            folder,
            makes_again: false,
        }
    }

    /// The same, for a user who wants no mesh of before.
    #[must_use]
    pub fn making_again(self) -> Self {
        Self {
            makes_again: true,
            ..self
        }
    }

    /// Copies a mesh to `output`, if it is there and whole.
    pub(super) fn fetch(&self, key: Fingerprint, output: &Path) -> Option<Record> {
        if self.makes_again {
            return None;
        }
        let place = self.place(key);
        let record = fs::read(place.join(RECORD)).ok()?;
        let record: Option<Record> = serde_json::from_slice(&record).ok();
        let copied = fs::copy(place.join(MESH), output).is_ok();
        let sum = fingerprint_of(output).ok().map(written);
        let record = record.filter(|record| copied && sum.as_ref() == Some(&record.sum));
        if record.is_none() {
            // Damaged: it is made again, and kept in its place.
            let _ = fs::remove_file(output);
            let _ = fs::remove_dir_all(&place);
            return None;
        }
        // Only who may write there needs to know what was asked for last.
        let asked = File::options().append(true).open(place.join(RECORD));
        let _ = asked.and_then(|file| file.set_modified(SystemTime::now()));
        record
    }

    /// Keeps a mesh with what is known of it beside its sum.
    pub(super) fn keep(&self, key: Fingerprint, mesh: &Path, about: Record) -> io::Result<()> {
        make_private(&self.folder)?;
        let unfinished = tempfile::Builder::new()
            .prefix(UNFINISHED)
            .tempdir_in(&self.folder)?;
        let copy = unfinished.path().join(MESH);
        fs::copy(mesh, &copy)?;
        let sum = fingerprint_of(&copy).map_err(|defect| io::Error::other(defect.problem))?;
        let record = Record {
            sum: written(sum),
            ..about
        };
        fs::write(
            unfinished.path().join(RECORD),
            serde_json::to_vec_pretty(&record)?,
        )?;
        let place = self.place(key);
        if self.makes_again {
            let _ = fs::remove_dir_all(&place);
        }
        match fs::rename(unfinished.path(), &place) {
            // Somebody else was faster with the same mesh.
            Err(_) if place.join(RECORD).exists() => {}
            renamed => renamed?,
        }
        self.make_room(LARGEST)
    }

    fn place(&self, key: Fingerprint) -> PathBuf {
        self.folder.join(written(key))
    }

    /// Removes the meshes that nobody has asked for longest, until all take at most `largest`.
    fn make_room(&self, largest: u64) -> io::Result<()> {
        let mut all = Vec::new();
        for entry in fs::read_dir(&self.folder)? {
            let place = entry?.path();
            if is_left_behind(&place) {
                let _ = fs::remove_dir_all(&place);
            }
            // Another process may remove one at any time.
            let asked = fs::metadata(place.join(RECORD)).and_then(|file| file.modified());
            let size = fs::metadata(place.join(MESH)).map(|file| file.len());
            if let (Ok(asked), Ok(size)) = (asked, size) {
                all.push((asked, place, size));
            }
        }
        all.sort();
        let mut total: u64 = all.iter().map(|(.., size)| size).sum();
        for (_, place, size) in all {
            if total <= largest {
                break;
            }
            let _ = fs::remove_dir_all(place);
            total -= size;
        }
        Ok(())
    }
}

/// Makes a folder that only its owner looks into.
fn make_private(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

fn written(sum: Fingerprint) -> String {
    format!("{sum:032x}")
}

/// Whether a process died while it kept a mesh there.
fn is_left_behind(place: &Path) -> bool {
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    let begun = fs::metadata(place).and_then(|folder| folder.modified());
    let age = begun.ok().and_then(|begun| begun.elapsed().ok());
    name.starts_with(UNFINISHED) && age.is_some_and(|age| age > LONGEST_COPY)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Place {
        folder: tempfile::TempDir,
        cache: MeshCache,
    }

    fn about() -> Record {
        Record {
            sum: String::new(),
            seconds: 1.5,
            warnings: vec!["w".into()],
            version: Some("4.8.4".into()),
        }
    }

    impl Place {
        fn new() -> Self {
            let folder = tempfile::tempdir().expect("a folder");
            let cache = MeshCache::at(folder.path().join("a/meshes"));
            Self { folder, cache }
        }

        fn path(&self, name: &str) -> PathBuf {
            self.folder.path().join(name)
        }

        fn keep(&self, key: Fingerprint, mesh: &str) {
            fs::write(self.path("made"), mesh).expect("written");
            let kept = self.cache.keep(key, &self.path("made"), about());
            kept.expect("kept");
        }

        fn fetch(&self, key: Fingerprint) -> Option<String> {
            let record = self.cache.fetch(key, &self.path("got"))?;
            assert_eq!((record.seconds, record.warnings.len()), (1.5, 1));
            assert_eq!(record.version.as_deref(), Some("4.8.4"));
            fs::read_to_string(self.path("got")).ok()
        }
    }

    #[test]
    fn what_is_kept_is_found_under_its_key_alone() {
        let place = Place::new();
        assert_eq!(place.fetch(1), None);
        place.keep(1, "one");
        place.keep(2, "two");
        place.keep(1, "never in place of what is there");
        assert_eq!(place.fetch(1).as_deref(), Some("one"));
        assert_eq!(place.fetch(3), None);
        let again = place.cache.clone().making_again();
        assert_eq!(again.fetch(1, &place.path("got")), None);
        again.keep(1, &place.path("made"), about()).expect("kept");
        assert_ne!(place.fetch(1).as_deref(), Some("one"));
    }

    #[test]
    fn a_damaged_mesh_is_none() {
        let place = Place::new();
        for file in [MESH, RECORD] {
            place.keep(1, "one");
            fs::write(place.cache.place(1).join(file), "onf").expect("written");
            assert_eq!(place.fetch(1), None, "{file}");
            assert!(!place.cache.place(1).exists() && !place.path("got").exists());
        }
    }

    #[test]
    fn what_was_not_asked_for_longest_goes_first() {
        let place = Place::new();
        for (key, age) in [(1, 30), (2, 20), (3, 10)] {
            place.keep(key, "123456");
            let record = place.cache.place(key).join(RECORD);
            let long_ago = SystemTime::now() - std::time::Duration::from_secs(age);
            let file = File::options().append(true).open(record).expect("there");
            file.set_modified(long_ago).expect("set");
        }
        assert!(place.fetch(1).is_some());
        place.cache.make_room(12).expect("room");
        assert_eq!(place.fetch(2), None);
        assert!(place.fetch(1).is_some() && place.fetch(3).is_some());
    }
}
