//! The tutorial's commands run as its pages say, and print what the pages show.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Says on a line of the pages that the command before it ends with exit status 1.
const FAILS: &str = "# exit status 1";

fn page(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../docs/tutorial")
        .join(name)
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

/// A text with one space between words: pages do not follow a table whose columns become wider.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Follows these pages in one folder. A `text` block shows lines of what the commands before it print, or of the log.
fn follow(pages: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let log = std::fs::read_to_string(page("arm-step.csv")).unwrap();
    std::fs::write(folder.path().join("arm-step.csv"), &log).unwrap();
    let mut printed = words(&log);
    for name in pages {
        let text = std::fs::read_to_string(page(name)).unwrap();
        let mut shown = 0;
        for (language, block) in blocks(&text) {
            match language {
                "sh" => printed = words(&run(block, folder.path())),
                "toml" => std::fs::write(folder.path().join("shaper.toml"), block).unwrap(),
                "text" => {
                    for line in block.lines().filter(|line| *line != "…") {
                        assert!(
                            printed.contains(&words(line)),
                            "{name} shows `{line}`, but printed is\n{printed}"
                        );
                        shown += 1;
                    }
                }
                other => panic!("{name}: a block of `{other}`"),
            }
        }
        assert!(shown > 0, "{name} shows nothing");
    }
}

#[test]
fn cli_the_tutorial_measures_and_designs_as_it_says() {
    follow(&["1-measure.md", "2-design.md"]);
}

#[test]
fn long_the_whole_tutorial_runs_as_it_says() {
    follow(&["1-measure.md", "2-design.md", "3-prove.md", "4-build.md"]);
}
