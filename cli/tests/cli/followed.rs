//! Follows pages of the documentation: runs their commands, and compares what the pages show with what is printed.

#![cfg(test)] // lets clippy see that this is test code

use std::path::{Path, PathBuf};
use std::process::Command;

/// Says on a line of the pages that the command before it ends with exit status 1.
const FAILS: &str = "# exit status 1";

/// What is in commands that take seconds to minutes: they simulate Verilog, or prove of shapers for four modes that none is shorter.
const SLOW: [&str; 2] = ["posicast run", "--compare --band 3"];

/// Which commands of a page are run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Commands {
    All,
    /// Without the blocks that have a slow command. What the page shows of them is not compared.
    Fast,
}

/// The path of a page or of a file beside it, by its path in `docs`.
pub(crate) fn docs(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs").join(path)
}

/// A text with one space between words: pages do not follow a table whose columns become wider.
pub(crate) fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Runs the commands of a page in this folder, and compares each line of a `text` block with what the commands before it
/// print; before the first of them, with `printed`. A `toml` block is written to `shaper.toml`.
pub(crate) fn follow(page: &Path, folder: &Path, printed: &str, commands: Commands) {
    let text = std::fs::read_to_string(page).unwrap();
    let mut printed = Some(words(printed));
    let mut shown = 0;
    for (language, block) in blocks(&text) {
        match language {
            "sh" if commands == Commands::Fast && SLOW.iter().any(|slow| block.contains(slow)) => printed = None,
            "sh" => printed = Some(words(&run(block, folder))),
            "toml" => std::fs::write(folder.join("shaper.toml"), block).unwrap(),
            "text" => {
                let Some(printed) = &printed else { continue };
                for line in block.lines().filter(|line| *line != "…") {
                    assert!(
                        printed.contains(&words(line)),
                        "{} shows `{line}`, but printed is\n{printed}",
                        page.display()
                    );
                    shown += 1;
                }
            }
            other => panic!("{}: a block of `{other}`", page.display()),
        }
    }
    assert!(shown > 0, "{} shows nothing", page.display());
}

/// The fenced blocks of a page, each with its language.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let parts = page.split("```").skip(1).step_by(2);
    parts.map(|block| block.split_once('\n').unwrap()).collect()
}

/// Runs the commands of a block in a shell, the last of which fails if the block says so, and returns what they print.
fn run(commands: &str, folder: &Path) -> String {
    let programs = Path::new(env!("CARGO_BIN_EXE_posicast")).parent().unwrap();
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap());
    let output = Command::new("sh")
        .args(["-e", "-c", commands])
        .current_dir(folder)
        .env("PATH", path)
        .output()
        .unwrap();
    let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    let expected = i32::from(commands.contains(FAILS));
    assert_eq!(output.status.code(), Some(expected), "{commands}{}", printed.concat());
    printed.concat()
}
