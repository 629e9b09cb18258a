//! `posicast.json`: the files that posicast wrote, with their hashes.
//!
//! ```json
//! {
//!   "version": "0.1.0",
//!   "machine": "xy_stage",
//!   "files": { "machine.toml": "sha256:9f86d0…", "rtl/xy_stage.v": "sha256:60303a…", "wave/rtl.vcd": "sha256:fcde2b…" },
//!   "evidence": { "of": "sha256:a665a4…", "files": ["wave/rtl.vcd"] }
//! }
//! ```
//!
//! `evidence` lists the files with the results of a run, and `of` is the hash of the run's subject: path and hash of
//! `machine.toml` and of every file in `rtl/`, a line each.
//!
//! While files are being replaced, `replaces` lists for each path the other contents that may be found there.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::error::{PackageError, at};
use super::layout::{MANIFEST, STAGING};
use super::names;
use super::text::read_text;

/// Contents of the file.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Manifest {
    /// Version of posicast that wrote the folder.
    pub(super) version: String,
    /// Name of the machine.
    pub(super) machine: String,
    files: BTreeMap<String, String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    evidence: Option<Evidence>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    replaces: BTreeMap<String, BTreeSet<String>>,
}

/// The files with the results of a run, and its subject.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Evidence {
    /// [`subject`] of the package that was run.
    of: String,
    files: BTreeSet<String>,
}

/// Hash of a run's subject: the machine file and the Verilog. `files` maps paths to hashes.
fn subject(files: &BTreeMap<String, String>) -> String {
    let counts = |path: &str| path == "machine.toml" || path.starts_with("rtl/");
    let lines = files.iter().filter(|(path, _)| counts(path));
    let lines: String = lines.map(|(path, hash)| format!("{path} {hash}\n")).collect();
    digits(Sha256::digest(lines))
}

impl Manifest {
    /// The manifest of a finished package. `files` maps paths to hashes; `evidence` names those of them that are
    /// results about the others.
    pub(super) fn new(machine: &str, files: BTreeMap<String, String>, evidence: BTreeSet<String>) -> Self {
        let evidence = (!evidence.is_empty()).then(|| Evidence {
            of: subject(&files),
            files: evidence,
        });
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            machine: machine.to_owned(),
            files,
            evidence,
            replaces: BTreeMap::new(),
        }
    }

    /// The manifest while files of `previous` may still be in place.
    pub(super) fn replacing(&self, previous: &Self) -> Self {
        let mut replaces = previous.replaces.clone();
        for (path, hash) in &previous.files {
            replaces.entry(path.clone()).or_default().insert(hash.clone());
        }
        // A first run has nothing to replace, but is unfinished too.
        for path in self.files.keys() {
            replaces.entry(path.clone()).or_default();
        }
        Self {
            replaces,
            ..self.clone()
        }
    }

    /// Whether the run that wrote it was interrupted.
    pub(super) fn unfinished(&self) -> bool {
        !self.replaces.is_empty()
    }

    /// All paths that posicast may have written.
    pub(super) fn paths(&self) -> impl Iterator<Item = &str> {
        let paths: BTreeSet<&str> = self
            .files
            .keys()
            .chain(self.replaces.keys())
            .map(String::as_str)
            .collect();
        paths.into_iter()
    }

    /// Paths of the evidence.
    pub(super) fn evidence(&self) -> impl Iterator<Item = &str> {
        let evidence = self.evidence.iter().flat_map(|evidence| &evidence.files);
        evidence.map(String::as_str)
    }

    /// The evidence that is valid for a package of these files, path to hash, and is still in place. A folder whose
    /// last run was interrupted has none, because its files may be from two runs.
    pub(super) fn evidence_of(&self, files: &BTreeMap<String, String>, root: &Path) -> BTreeMap<String, String> {
        let holds = |evidence: &&Evidence| !self.unfinished() && evidence.of == subject(files);
        let paths = self.evidence.iter().filter(holds).flat_map(|evidence| &evidence.files);
        let there = paths.filter(|path| root.join(path).symlink_metadata().is_ok());
        there
            .filter_map(|path| Some((path.clone(), self.files.get(path)?.clone())))
            .collect()
    }

    /// Whether posicast may have written this path.
    pub(super) fn names(&self, path: &str) -> bool {
        self.files.contains_key(path) || self.replaces.contains_key(path)
    }

    /// The paths whose files were changed since posicast wrote them. A missing file does not count as changed.
    pub(super) fn edited(&self, root: &Path) -> Result<Vec<String>, PackageError> {
        let mut edited = Vec::new();
        for path in self.paths() {
            let Some(hash) = hash_in(root, path)? else { continue };
            let current = self.files.get(path) == Some(&hash);
            if !current && !self.replaces.get(path).is_some_and(|hashes| hashes.contains(&hash)) {
                edited.push(path.to_owned());
            }
        }
        Ok(edited)
    }

    /// Reads the manifest of a folder; `None` without one.
    pub(super) fn of(root: &Path) -> Result<Option<Self>, PackageError> {
        let path = root.join(MANIFEST);
        let reject = |reason| {
            Err(PackageError::Manifest {
                folder: root.to_owned(),
                reason,
            })
        };
        let text = match read_text(&path) {
            Ok(text) => text,
            Err(PackageError::Missing(_)) => return Ok(None),
            Err(PackageError::Io { source, .. }) if source.kind() == ErrorKind::InvalidData => {
                return reject("is not text".to_owned());
            }
            Err(error) => return Err(error),
        };
        let manifest: Self = match serde_json::from_str(&text) {
            Ok(manifest) => manifest,
            Err(error) => return reject(format!("is not a manifest of posicast ({error})")),
        };
        // Its paths are removed and compared, so a path that leads out of the folder must not be followed.
        let outside = manifest.paths().find_map(|p| names::check(p).err());
        outside.map_or(Ok(Some(manifest)), |error| reject(error.to_string()))
    }

    /// The text of the file, which is the same for the same files.
    pub(super) fn to_json(&self) -> Result<String, PackageError> {
        let text = serde_json::to_string_pretty(self).map_err(|e| at("write", Path::new(MANIFEST))(e.into()))?;
        Ok(text + "\n")
    }
}

/// Hash of a file of the folder, `sha256:` and 64 hexadecimal digits; `None` if it does not exist.
///
/// # Errors
/// An error for anything other than folders on the way and a plain file at the end: a link could lead out of the
/// folder.
pub(super) fn hash_in(root: &Path, relative: &str) -> Result<Option<String>, PackageError> {
    let mut path = root.to_owned();
    let mut parts = relative.split('/').peekable();
    while let Some(part) = parts.next() {
        path.push(part);
        let is_last = parts.peek().is_none();
        let kind = match fs::symlink_metadata(&path) {
            Ok(metadata) => metadata.file_type(),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(at("read", &path)(error)),
        };
        let expected = if is_last { kind.is_file() } else { kind.is_dir() };
        if !expected {
            let found = match (kind.is_symlink(), kind.is_dir(), kind.is_file()) {
                (true, ..) => "a link",
                (_, true, _) => "a folder",
                (.., true) => "a file",
                _ => "a device",
            };
            let wanted = if is_last { "a file" } else { "a folder" };
            return Err(PackageError::WrongType { path, found, wanted });
        }
    }
    hash(&path).map(Some)
}

fn hash(path: &Path) -> Result<String, PackageError> {
    let mut file = File::open(path).map_err(at("read", path))?;
    let mut sha = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer).map_err(at("read", path))? {
            0 => break,
            count => sha.update(&buffer[..count]),
        }
    }
    Ok(digits(sha.finalize()))
}

/// `sha256:` with the digits.
fn digits(hash: impl AsRef<[u8]>) -> String {
    let digits: String = hash.as_ref().iter().map(|byte| format!("{byte:02x}")).collect();
    format!("sha256:{digits}")
}

/// The manifest of the previous run; an empty one for a folder that is missing or empty.
pub(super) fn inspect(root: &Path) -> Result<Manifest, PackageError> {
    let entries = match fs::read_dir(root) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Manifest::default()),
        Err(error) if error.kind() == std::io::ErrorKind::NotADirectory => {
            return Err(PackageError::NotAFolder(root.to_owned()));
        }
        Err(error) => return Err(at("read", root)(error)),
    };
    if let Some(manifest) = Manifest::of(root)? {
        return Ok(manifest);
    }
    for entry in entries {
        let entry = entry.map_err(at("read", root))?;
        if entry.file_name() != STAGING {
            return Err(PackageError::NotOurs(root.to_owned()));
        }
    }
    Ok(Manifest::default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_sha256() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a"), "abc").unwrap();
        // FIPS 180-2, appendix B.1
        let abc = "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(hash_in(folder.path(), "a").unwrap().unwrap(), abc);
        assert_eq!(hash_in(folder.path(), "b").unwrap(), None);
    }

    #[test]
    fn an_unfinished_manifest_accepts_every_generation() {
        let files = |hash: &str| BTreeMap::from([("a".to_owned(), hash.to_owned())]);
        let generation = |hash: &str| Manifest::new("m", files(hash), BTreeSet::new());
        let twice = generation("3").replacing(&generation("2").replacing(&generation("1")));
        assert!(twice.unfinished());
        assert_eq!(twice.replaces["a"], BTreeSet::from(["1".to_owned(), "2".to_owned()]));
    }
}
