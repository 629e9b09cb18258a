//! The output folder: its files, and which of them posicast may replace.
//!
//! ```text
//! DIR/machine.toml  rtl/*.v  sopc/  driver/ …      the package: what follows from the machine file
//! DIR/wave/*.vcd  plots/  input/  report.json      evidence: what a run found out about it
//! DIR/posicast.json                                version, machine, sha256 of every file written, which are evidence
//! DIR/.posicast-staging/                           while a run is at work
//! ```
//!
//! - A folder is **ours** if it does not exist, is empty, or contains `posicast.json`. Any other is refused.
//! - Files are written to the staging folder first. [`Package::commit`] checks everything, then renames;
//!   `posicast.json` comes last. A run that fails or is dropped before that leaves the folder as it was.
//! - A file is replaced or removed only if it is unchanged since posicast wrote it: its hash is in `posicast.json`. A
//!   file that was edited since is an error that names it, before anything is touched. Files that posicast never
//!   wrote are not touched.
//! - **Evidence** is about one machine file and one set of Verilog files. If a package is written again with both
//!   unchanged, its evidence is kept, and files with its names are not touched. With another machine file or other
//!   Verilog it is removed: evidence about another machine would be misleading. Removed evidence is reported
//!   ([`Committed`]).
//! - A run that is killed between two renames leaves a `posicast.json` that lists both generations, so that the next
//!   run can finish the work; [`read()`] refuses the folder until then.
//! - SIGINT and SIGTERM leave the folder as it was, or complete if they come while files are being put in place.
//! - Two runs on one folder exclude each other by a lock on the folder.
//!
//! ```
//! # let scratch = tempfile::tempdir()?;
//! # let folder = scratch.path().join("xy_stage");
//! use posicast_synth::package::{self, Package};
//!
//! let mut package = Package::open(&folder, "xy_stage")?;
//! package.add("machine.toml", b"name = \"xy_stage\"\n")?;
//! package.add("rtl/xy_stage.v", b"module xy_stage;\nendmodule\n")?;
//! std::fs::write(package.stage("wave/rtl.vcd")?, "$enddefinitions $end\n")?; // large files: written in place
//! package.commit()?;
//!
//! let contents = package::read(&folder)?;
//! assert_eq!(contents.machine, "xy_stage");
//! assert_eq!(contents.rtl, [folder.join("rtl/xy_stage.v")]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod layout;
mod manifest;
mod names;
mod read;
mod staging;
mod text;

pub use error::PackageError;
pub use layout::MANIFEST;
pub use read::{Contents, read};

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use posicast_system::interrupt;

use error::at;
use manifest::{Manifest, inspect};
use staging::Staging;

/// An output folder that is being written. Nothing appears in it before [`commit`](Package::commit).
#[derive(Debug)]
pub struct Package {
    root: PathBuf,
    machine: String,
    previous: Manifest,
    staging: Staging,
    files: BTreeSet<String>,
    /// The staged files that are evidence; `None` if this run makes none.
    evidence: Option<BTreeSet<String>>,
}

/// Result of a commit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Committed {
    /// All files that were written, including those that existed before; sorted, the manifest last.
    pub files: Vec<PathBuf>,
    /// Evidence of an earlier run that is valid for this package too and was kept; paths relative to the folder.
    pub kept: Vec<String>,
    /// Evidence of an earlier run that was removed or replaced because it was about another machine file or other Verilog.
    pub outdated: Vec<String>,
    /// Other files of an earlier run that were removed because they are no longer produced.
    pub removed: Vec<String>,
}

impl Package {
    /// Claims `root` for a run, creating it where it is missing. `machine` is the machine's name.
    ///
    /// # Errors
    /// An error if the folder is not ours, contains files edited since posicast wrote them, is in use by another run,
    /// or cannot be written. The folder is then unchanged.
    pub fn open(root: &Path, machine: &str) -> Result<Self, PackageError> {
        let previous = inspect(root)?;
        let mut edited = previous.edited(root)?;
        // Only the finished package decides whether edited evidence is in the way.
        edited.retain(|path| !previous.evidence().any(|evidence| evidence == path));
        refuse_edited(root, edited)?;
        Ok(Self {
            root: root.to_owned(),
            machine: machine.to_owned(),
            previous,
            staging: Staging::claim(root)?,
            files: BTreeSet::new(),
            evidence: None,
        })
    }

    /// Declares that this run makes evidence, which replaces all existing evidence.
    ///
    /// # Errors
    /// An error if existing evidence was edited since posicast wrote it.
    pub fn with_evidence(mut self) -> Result<Self, PackageError> {
        refuse_edited(&self.root, self.previous.edited(&self.root)?)?;
        self.evidence = Some(BTreeSet::new());
        Ok(self)
    }

    /// Path of the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Adds a file. `relative` is its path in the folder, with `/` between the parts.
    ///
    /// # Errors
    /// An error for a path that leaves the folder or was added before, and for a file that cannot be written.
    pub fn add(&mut self, relative: &str, bytes: &[u8]) -> Result<(), PackageError> {
        let path = self.stage(relative)?;
        fs::write(&path, bytes).map_err(at("write", &path))
    }

    /// Adds a file of evidence, as [`add`](Package::add) does.
    ///
    /// # Errors
    /// Those of [`add`](Package::add).
    pub fn add_evidence(&mut self, relative: &str, bytes: &[u8]) -> Result<(), PackageError> {
        let path = self.stage_evidence(relative)?;
        fs::write(&path, bytes).map_err(at("write", &path))
    }

    /// Announces a file of evidence, as [`stage`](Package::stage) does.
    ///
    /// # Errors
    /// Those of [`stage`](Package::stage).
    pub fn stage_evidence(&mut self, relative: &str) -> Result<PathBuf, PackageError> {
        let path = self.stage(relative)?;
        self.evidence.get_or_insert_default().insert(relative.to_owned());
        Ok(path)
    }

    /// Announces a file that the caller writes itself, because it is too large to hold in memory, and returns its
    /// path. The folders of the path exist then.
    ///
    /// # Errors
    /// Those of [`add`](Package::add).
    pub fn stage(&mut self, relative: &str) -> Result<PathBuf, PackageError> {
        names::check(relative)?;
        let path = self.staging.path().join(relative);
        if let Some(parent) = path.parent() {
            // A signal, which removes the staging folder, must not come before this.
            interrupt::uninterrupted(|| fs::create_dir_all(parent)).map_err(at("create", parent))?;
        }
        if !self.files.insert(relative.to_owned()) {
            return Err(PackageError::Twice(relative.to_owned()));
        }
        Ok(path)
    }

    /// Puts the files in place, removes those of the earlier run that are no longer produced, and writes the manifest.
    ///
    /// # Errors
    /// An error for a staged file that was never written, and for a file in the way that posicast did not write or
    /// that was edited: the folder is then unchanged. A rename that fails midway leaves a folder that the next run
    /// completes.
    pub fn commit(mut self) -> Result<Committed, PackageError> {
        let plan = self.plan()?;
        interrupt::uninterrupted(|| self.carry_out(&plan))?;
        self.staging.keep_folder();
        let names = plan.hashes.keys().map(String::as_str).chain([MANIFEST]);
        let files = names.map(|name| self.root.join(name)).collect();
        let was_evidence = |path: &String| self.previous.evidence().any(|evidence| evidence == path);
        let outdated = match self.evidence {
            Some(_) => Vec::new(),
            None => self.previous.evidence().map(str::to_owned).collect(),
        };
        Ok(Committed {
            files,
            outdated: outdated
                .into_iter()
                .filter(|path| !plan.kept.contains_key(path))
                .collect(),
            kept: plan.kept.into_keys().collect(),
            removed: plan.obsolete.into_iter().filter(|path| !was_evidence(path)).collect(),
        })
    }

    /// Decides what happens to every file, and refuses to touch files that are not posicast's.
    fn plan(&self) -> Result<Plan, PackageError> {
        let mut hashes = self.hash_staged()?;
        let kept = match self.evidence {
            Some(_) => BTreeMap::new(),
            None => self.previous.evidence_of(&hashes, &self.root),
        };
        hashes.retain(|path, _| !kept.contains_key(path));
        let mut changed = Vec::new();
        let mut edited = self.previous.edited(&self.root)?;
        edited.retain(|path| !kept.contains_key(path));
        let mut foreign = Vec::new();
        for (relative, hash) in &hashes {
            match manifest::hash_in(&self.root, relative)? {
                Some(found) if found == *hash => edited.retain(|e| e != relative),
                Some(_) if !self.previous.names(relative) => foreign.push(relative.clone()),
                _ => changed.push(relative.clone()),
            }
        }
        refuse_edited(&self.root, edited)?;
        if !foreign.is_empty() {
            return Err(PackageError::InTheWay {
                folder: self.root.clone(),
                files: foreign,
            });
        }
        let obsolete = self
            .previous
            .paths()
            .filter(|p| !hashes.contains_key(*p) && !kept.contains_key(*p))
            .map(str::to_owned)
            .collect();
        Ok(Plan {
            hashes,
            kept,
            changed,
            obsolete,
        })
    }

    /// Carries out the plan. From the first rename to the last, the manifest lists both generations.
    fn carry_out(&self, plan: &Plan) -> Result<(), PackageError> {
        let evidence = match &self.evidence {
            Some(evidence) => evidence.clone(),
            None => plan.kept.keys().cloned().collect(),
        };
        let files = plan.hashes.iter().chain(&plan.kept);
        let files = files.map(|(path, hash)| (path.clone(), hash.clone())).collect();
        let last = Manifest::new(&self.machine, files, evidence);
        if !plan.changed.is_empty() || !plan.obsolete.is_empty() {
            self.write_manifest(&last.replacing(&self.previous))?;
        }
        for relative in &plan.changed {
            self.put(relative)?;
        }
        for relative in &plan.obsolete {
            self.remove(relative)?;
        }
        self.write_manifest(&last)
    }

    fn hash_staged(&self) -> Result<BTreeMap<String, String>, PackageError> {
        let hash = |relative: &String| match manifest::hash_in(self.staging.path(), relative)? {
            Some(hash) => Ok((relative.clone(), hash)),
            None => Err(PackageError::NotWritten(relative.clone())),
        };
        self.files.iter().map(hash).collect()
    }

    fn put(&self, relative: &str) -> Result<(), PackageError> {
        let target = self.root.join(relative);
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent).map_err(at("create", parent))?;
        }
        fs::rename(self.staging.path().join(relative), &target).map_err(at("write", &target))
    }

    /// Removes a file of an earlier run, and the folders that become empty.
    fn remove(&self, relative: &str) -> Result<(), PackageError> {
        let path = self.root.join(relative);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(at("remove", &path)(error)),
            _ => {}
        }
        let folders = path.ancestors().skip(1).take_while(|folder| *folder != self.root);
        for folder in folders {
            if fs::remove_dir(folder).is_err() {
                break; // not empty: it is still in use
            }
        }
        Ok(())
    }

    fn write_manifest(&self, manifest: &Manifest) -> Result<(), PackageError> {
        let staged = self.staging.path().join(MANIFEST);
        let target = self.root.join(MANIFEST);
        fs::write(&staged, manifest.to_json()?).map_err(at("write", &staged))?;
        fs::rename(&staged, &target).map_err(at("write", &target))
    }
}

/// Actions of a commit; all paths are relative to the folder.
struct Plan {
    /// Staged files that must be in place afterwards, with their hashes.
    hashes: BTreeMap<String, String>,
    /// Evidence of an earlier run that is kept, with its hashes.
    kept: BTreeMap<String, String>,
    /// Staged files that are not in place yet.
    changed: Vec<String>,
    /// Files of the earlier run that are no longer produced.
    obsolete: Vec<String>,
}

fn refuse_edited(folder: &Path, files: Vec<String>) -> Result<(), PackageError> {
    if files.is_empty() {
        return Ok(());
    }
    Err(PackageError::Edited {
        folder: folder.to_owned(),
        files,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn staged(root: &Path, text: &str) -> Package {
        let mut package = Package::open(root, "m").unwrap();
        package.add("machine.toml", text.as_bytes()).unwrap();
        package.add("rtl/m.v", text.as_bytes()).unwrap();
        package
    }

    #[test]
    fn a_run_that_fails_between_two_renames_is_completed_by_the_next() {
        for first_run in [true, false] {
            let folder = tempfile::tempdir().unwrap();
            let root = folder.path();
            if !first_run {
                staged(root, "old").commit().unwrap();
            }
            let package = staged(root, "new");
            let plan = package.plan().unwrap();
            fs::remove_file(package.staging.path().join("rtl/m.v")).unwrap();
            assert!(package.carry_out(&plan).is_err());
            drop(package);

            assert_eq!(fs::read_to_string(root.join("machine.toml")).unwrap(), "new");
            assert!(matches!(read(root), Err(PackageError::Unfinished(_))));
            staged(root, "newest").commit().unwrap();
            let contents = read(root).unwrap();
            assert_eq!(contents.machine_toml, "newest");
            assert_eq!(fs::read_to_string(&contents.rtl[0]).unwrap(), "newest");
        }
    }
}
