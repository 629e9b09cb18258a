//! The pages for users: their links lead somewhere, and the book has all of them.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The Markdown files of a folder.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .collect()
}

/// Targets of a page's links to files, without their anchors.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split([')', '#']).next());
    targets.filter(|target| !target.is_empty() && !target.contains(':'))
}

#[test]
fn every_link_of_the_pages_leads_to_a_file() {
    let root = root();
    let mut all = pages(&root);
    for folder in ["docs", "docs/tutorial", "docs/examples", "waves"] {
        all.extend(pages(&root.join(folder)));
    }
    let mut followed = 0;
    for page in all {
        let text = std::fs::read_to_string(&page).unwrap();
        for target in links(&text) {
            assert!(page.with_file_name(target).exists(), "{}: {target}", page.display());
            followed += 1;
        }
    }
    assert!(followed > 100, "{followed} links");
}

#[test]
fn the_book_has_every_page() {
    let docs = root().join("docs");
    let summary = std::fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let chapters: Vec<&str> = links(&summary).collect();
    for folder in ["", "tutorial/", "examples/"] {
        for page in pages(&docs.join(folder)) {
            let name = format!("{folder}{}", page.file_name().unwrap().to_str().unwrap());
            assert!(
                name == "SUMMARY.md" || chapters.contains(&name.as_str()),
                "docs/SUMMARY.md lacks {name}"
            );
        }
    }
}
