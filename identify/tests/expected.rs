//! The modes that were found beside those that the machine has.

use posicast_identify::FoundMode;
use posicast_identify::synthetic::KnownMode;

/// Largest relative errors of frequency and damping ratio, and largest error of a participation.
const FREQUENCY: f64 = 0.01;
const DAMPING: f64 = 0.1;
const PARTICIPATION: f64 = 0.03;

/// Requires that exactly the modes of a machine were found.
pub(crate) fn check(truths: &[KnownMode], found: &[FoundMode]) {
    check_poles(truths, found);
    let whole: f64 = truths.iter().map(|truth| truth.share).sum();
    for (truth, found) in truths.iter().zip(found) {
        let participation = found.participation - truth.share / whole;
        assert!(participation.abs() < PARTICIPATION, "{truth:#?} {found:#?}");
    }
}

/// The same without the participations.
pub(crate) fn check_poles(truths: &[KnownMode], found: &[FoundMode]) {
    assert_eq!(truths.len(), found.len(), "{truths:#?} {found:#?}");
    for (truth, found) in truths.iter().zip(found) {
        let frequency = found.mode.frequency_hz / truth.mode.frequency_hz - 1.0;
        let damping = found.mode.damping / truth.mode.damping - 1.0;
        assert!(
            frequency.abs() < FREQUENCY && damping.abs() < DAMPING,
            "{truth:#?} {found:#?}"
        );
    }
}
