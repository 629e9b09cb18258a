//! Rounding: the sum to the last bit, what the command may do, and the residual of the integers.

use crate::support::{SIGNED, TWO_MODES, four_modes, request, worst_ratio};
use posicast_optimal::{Command, Request, round_taps, shortest};

fn integers(request: &Request, fraction: u32) -> (Vec<(u32, i64)>, f64) {
    let found = shortest(request).unwrap();
    let units = round_taps(request, &found.taps, fraction);
    let unity = f64::from(1u32 << fraction);
    let taps: Vec<(u32, f64)> = units
        .iter()
        .map(|(sample, units)| (*sample, *units as f64 / unity))
        .collect();
    assert_eq!(units.iter().map(|(_, units)| units).sum::<i64>(), 1 << fraction);
    assert_eq!(
        units.last().unwrap().0,
        found.taps.last().unwrap().0,
        "the last tap stays"
    );
    assert!(units.iter().all(|(_, units)| *units != 0));
    (units, worst_ratio(request, &taps))
}

#[test]
fn integers_keep_every_tolerance_to_a_unit_of_the_last_place() {
    // ±10 % has no room at its least duration: two dozen integers cannot meet a dozen peaks to the last digit.
    for (width, units_above) in [(0.0, 0.0), (0.05, 0.0), (0.1, 1.0)] {
        let request = request(400.0, &four_modes(), 0.05, width);
        let (units, worst) = integers(&request, 16);
        assert!(units.iter().all(|(_, units)| *units > 0));
        let unit = 2f64.powi(-16) / 0.05;
        assert!(worst <= 1.0 + 1e-6 + units_above * unit, "{width} {worst}");
    }
}

#[test]
fn signed_integers_stay_within_their_bounds_exactly() {
    let request = Request {
        command: SIGNED,
        ..request(20_000.0, &TWO_MODES, 0.001, 0.0)
    };
    let (units, worst) = integers(&request, 15);
    let mut sum = 0;
    for (_, units) in &units {
        sum += units;
        assert!((-(1 << 15)..=1 << 15).contains(&sum), "{sum}");
    }
    assert!(worst <= 1.0 + 1e-6, "{worst}");
}

#[test]
fn units_move_where_rounding_alone_breaks_a_tolerance() {
    // Six fraction bits: a unit is 1.6 %, and the nearest integers leave more than the 5 % that better ones do.
    let request = request(200.0, &[(1.0, 0.0)], 0.05, 0.1);
    let exact = [(0, 0.2625), (89, 0.475), (178, 0.2625)];
    let unity = 64.0;
    let nearest = [(0, 17.0 / unity), (89, 30.0 / unity), (178, 17.0 / unity)];
    let units = round_taps(&request, &exact, 6);
    let moved: Vec<(u32, f64)> = units
        .iter()
        .map(|(sample, units)| (*sample, *units as f64 / unity))
        .collect();
    assert!(worst_ratio(&request, &moved) <= worst_ratio(&request, &nearest));
    assert_eq!(request.command, Command::Positive);
}
