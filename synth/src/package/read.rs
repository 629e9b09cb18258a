//! Reads an output folder: `verify DIR` and `synth DIR` work on the Verilog as it is there.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::error::{PackageError, at};
use super::manifest::{Manifest, inspect};
use super::text::read_text;

/// The machine file of a folder.
const MACHINE: &str = "machine.toml";

/// Contents of an output folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Contents {
    /// Version of posicast that wrote it.
    pub version: String,
    /// Name of the machine, which is also that of the top module.
    pub machine: String,
    /// Path of `machine.toml`.
    pub machine_path: PathBuf,
    /// Text of `machine.toml`.
    pub machine_toml: String,
    /// Paths of the present `rtl/*.v`, sorted: at least one.
    pub rtl: Vec<PathBuf>,
    /// Files that were changed since posicast wrote them, as paths below the folder.
    pub edited: Vec<String>,
}

/// Reads an output folder. Files may have been edited since posicast wrote them, because that is what a user
/// verifies.
///
/// # Errors
/// An error for a path that is not a folder, was not written by posicast or not completely, has a block alone, or lacks `machine.toml`
/// or one of the files in `rtl/` that posicast wrote: a missing component would go unnoticed.
pub fn read(root: &Path) -> Result<Contents, PackageError> {
    if !root.exists() {
        return Err(PackageError::Missing(root.to_owned()));
    }
    let manifest = match inspect(root) {
        Ok(manifest) if manifest != Manifest::default() => manifest,
        Ok(_) | Err(PackageError::NotOurs(_)) => return Err(PackageError::NotAPackage(root.to_owned())),
        Err(error) => return Err(error),
    };
    if manifest.unfinished() {
        return Err(PackageError::Unfinished(root.to_owned()));
    }
    if !manifest.paths().any(|path| path == MACHINE) {
        return Err(PackageError::BlockAlone {
            folder: root.to_owned(),
            block: manifest.machine,
        });
    }
    let machine_path = root.join(MACHINE);
    let machine_toml = read_text(&machine_path)?;
    let rtl = verilog_in(&root.join("rtl"))?;
    let written = manifest.paths().filter(|path| path.starts_with("rtl/"));
    if let Some(gone) = written.map(|path| root.join(path)).find(|path| !path.is_file()) {
        return Err(PackageError::Missing(gone));
    }
    Ok(Contents {
        edited: manifest.edited(root)?,
        version: manifest.version,
        machine: manifest.machine,
        machine_toml,
        machine_path,
        rtl,
    })
}

fn verilog_in(folder: &Path) -> Result<Vec<PathBuf>, PackageError> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Err(PackageError::Missing(folder.to_owned())),
        Err(error) => return Err(at("read", folder)(error)),
    };
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(at("read", folder))?.path();
        if path.extension().is_some_and(|e| e == "v") && path.is_file() {
            files.push(path);
        }
    }
    if files.is_empty() {
        return Err(PackageError::Missing(folder.join("*.v")));
    }
    files.sort();
    Ok(files)
}
