//! Logs of random machines.

use posicast_identify::trial;

/// `posicast campaign identify` has as many as you like.
#[test]
fn the_modes_of_random_machines_are_found_again() {
    let report = trial::run(0..8);
    assert_eq!((report.logs, report.wrong.as_slice()), (8, &[][..]));
    assert!(report.modes > report.logs && report.frequencies_held <= report.modes);
    // Of intervals that hold the truth with 95 %, less than three quarters of so few would be no chance.
    let least = report.modes * 3 / 4;
    assert!(
        report.frequencies_held >= least && report.dampings_held >= least,
        "{report:?}"
    );
}
