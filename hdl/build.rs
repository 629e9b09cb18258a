//! Collects the module documentation of every kernel's file: it becomes the header comment of the module's Verilog.
//!
//! ```text
//! src/**/*.rs with `comment!("@module NAME")` ─► (NAME, its `//!` lines) ─► $OUT_DIR/heads.rs
//! ```

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=src");
    let mut files = Vec::new();
    collect(Path::new("src"), &mut files)?;
    files.sort();
    let mut heads = String::from("&[\n");
    for file in files {
        let source = fs::read_to_string(file)?;
        if let Some(name) = module_of(&source) {
            let head: Vec<&str> = source.lines().map_while(|line| line.strip_prefix("//!")).collect();
            let _ = writeln!(heads, "    ({name:?}, {:?}),", head.join("\n"));
        }
    }
    heads.push_str("]\n");
    let folder = env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("cargo sets OUT_DIR"))?;
    fs::write(PathBuf::from(folder).join("heads.rs"), heads)
}

/// Collects the Rust files of a folder and its subfolders.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// Returns the module name from the `@module` tag of a file, which has at most one kernel; tags in comments do not
/// count.
fn module_of(source: &str) -> Option<&str> {
    let mut lines = source.lines().map(str::trim_start);
    let tag = lines.find_map(|line| line.strip_prefix("comment!(\"@module "))?;
    tag.strip_suffix("\");")
}
