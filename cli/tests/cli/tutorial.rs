//! The tutorial's commands run as its pages say, and print what the pages show.

use super::followed::{Commands, docs, follow};

/// Follows these pages in one folder. The first `text` block shows lines of the log.
fn follow_pages(pages: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let log = std::fs::read_to_string(docs("tutorial/arm-step.csv")).unwrap();
    std::fs::write(folder.path().join("arm-step.csv"), &log).unwrap();
    for name in pages {
        follow(&docs("tutorial").join(name), folder.path(), &log, Commands::All);
    }
}

#[test]
fn cli_the_tutorial_measures_and_designs_as_it_says() {
    follow_pages(&["1-measure.md", "2-design.md"]);
}

#[test]
fn long_the_whole_tutorial_runs_as_it_says() {
    follow_pages(&["1-measure.md", "2-design.md", "3-prove.md", "4-build.md"]);
}
