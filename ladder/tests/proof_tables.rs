//! The table of proofs in `ladder/RESULTS.md` follows from the registry. `scripts/regenerate` writes it again.

use posicast_ladder::proofs::{MARKS, markdown};

#[test]
fn golden_the_table_of_proofs_is_what_the_registry_has() {
    let table = markdown().unwrap();
    if std::env::var_os("POSICAST_REGENERATE").is_some() {
        MARKS.renew(|_| table).unwrap();
    } else {
        assert!(
            MARKS.read().unwrap().trim() == table.trim(),
            "ladder/RESULTS.md lists other proofs than the registry; if the change is meant: scripts/regenerate"
        );
    }
}
