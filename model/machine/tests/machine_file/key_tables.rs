//! The tables of `docs/machine-file.md` agree with the keys that the reader takes. `scripts/regenerate` writes them again.

use posicast_machine::machine_file::with_tables;
use std::path::Path;

#[test]
fn golden_the_tables_of_keys_are_what_the_reader_takes() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/machine-file.md");
    let committed = std::fs::read_to_string(&page).unwrap();
    let derived = with_tables(&committed).unwrap_or_else(|mark| panic!("docs/machine-file.md has no place for {mark}"));
    if std::env::var_os("POSICAST_REGENERATE").is_some() {
        std::fs::write(&page, &derived).unwrap();
    } else {
        assert!(
            committed == derived,
            "docs/machine-file.md: a table is not what the keys say; if the change is meant: scripts/regenerate"
        );
    }
}
