//! The files of an output folder.

use std::path::Path;

/// Contents of the folder with these files, whose paths begin in it: subfolders with a `/` and their number of files, then
/// the names of the files.
pub(super) fn entries<'a>(files: impl Iterator<Item = &'a Path>) -> Vec<String> {
    let (mut folders, mut alone): (Vec<(String, usize)>, Vec<String>) = (Vec::new(), Vec::new());
    for file in files {
        let mut parts = file.iter();
        let first = parts.next().unwrap_or_default().to_string_lossy().into_owned();
        if parts.next().is_none() {
            alone.push(first);
        } else if let Some((_, count)) = folders.iter_mut().find(|(name, _)| *name == first) {
            *count += 1;
        } else {
            folders.push((first, 1));
        }
    }
    let folders = folders.into_iter().map(|(name, count)| format!("{name}/ ({count})"));
    folders.chain(alone).collect()
}
