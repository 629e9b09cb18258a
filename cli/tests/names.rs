//! Names that the crates share.

use crate::cli::support::{MODEL, rust_sources};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Names that every block has: its `Inputs` and `Outputs`, which are generated from its ports.
const OF_EVERY_BLOCK: [&str; 2] = ["Inputs", "Outputs"];
/// Names that every step has: what it is asked for, and its result.
const OF_EVERY_STEP: [&str; 2] = ["Options", "Document"];

#[test]
fn a_public_type_name_has_one_meaning() {
    let mut places: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    let others = [
        "system",
        "identify",
        "hdl",
        "waves",
        "testbench",
        "synth",
        "bitstream",
        "flow",
    ];
    for file in rust_sources(&[&MODEL[..], &others].concat()) {
        let text = std::fs::read_to_string(&file).unwrap();
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().take(3).collect();
            if let ["pub", "struct" | "enum" | "trait" | "type", name] = words[..] {
                let name = name.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
                // A macro's `$name` is not a name.
                if !name.is_empty() {
                    places.entry(name.to_owned()).or_default().push(file.clone());
                }
            }
        }
    }
    assert!(places.len() > 300, "{} types found", places.len());
    places.retain(|name, files| {
        let is_of_every = OF_EVERY_BLOCK.iter().chain(&OF_EVERY_STEP).any(|of| of == name);
        files.len() > 1 && !is_of_every
    });
    assert!(places.is_empty(), "{places:#?}");
}
