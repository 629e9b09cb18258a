//! "antisymmetry": one shaper for many modes whose frequencies are odd multiples of one (Singh and Heppler 1993).

use super::designs::{amplitudes, chosen, mode_of_omega, shaper, times_s};
use super::minors::{Equation, minors_divisor};
use super::sheet::{Rule, Sheet};
use posicast_shaper::analysis::pole_sum;
use posicast_shaper::axis::ShaperChoice;
use posicast_shaper::design::DesignError;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::ratios::{common_divisor, partition};
use posicast_shaper::impulse::Impulse;
use posicast_shaper::mode::Mode;
use std::f64::consts::PI;

/// Damping ratio of both modes of the example.
const DAMPING: f64 = 0.01;
/// Sample period of the paper's simulations in seconds.
const GRID_S: f64 = 0.01;

/// The three printed impulses of the paper.
pub(super) const THREE_PRINTED: [f64; 3] = [0.30644, 0.49482, 0.19874];

pub(super) fn rows(sheet: &mut Sheet) -> Result<(), DesignError> {
    test(sheet)?;
    undamped(sheet)?;
    damped(sheet)?;
    effectiveness(sheet)
}

/// Returns the modes of the damped example: damped frequencies 2 and 14 rad/s.
pub(super) fn example_modes(damping: f64) -> [Mode; 2] {
    [2.0, 14.0].map(|damped| mode_of_omega(damped / (1.0 - damping * damping).sqrt(), damping))
}

/// Returns the antisymmetric shaper of a method.
pub(super) fn antisymmetric(method: &str, modes: &[Mode]) -> Result<Vec<Impulse>, DesignError> {
    let choice = ShaperChoice {
        method: Some(method.into()),
        ..ShaperChoice::of_kind(ShaperKind::Antisymmetric)
    };
    chosen(choice, modes).map(|designed| designed.impulses().to_vec())
}

/// Converts multiples to the numbers of a row.
fn numbers(multiples: &[u64]) -> Vec<f64> {
    multiples.iter().map(|m| *m as f64).collect()
}

/// Section 3: test for an antiperiod.
fn test(sheet: &mut Sheet) -> Result<(), DesignError> {
    let pair = common_divisor(&[2.0, 14.0])?;
    sheet.equal("section 4: ω_c of 2, 14 rad/s", "2", pair.divisor);
    sheet.equal("section 4: m of 2, 14 rad/s", ["1", "7"], numbers(&pair.multiples));
    let half = |divisor: f64| PI / divisor;
    sheet.formula("section 4: T_a of 2, 14 rad/s in s: π/2", half(2.0), half(pair.divisor));
    let three = common_divisor(&[30.0, 105.0, 385.0])?;
    sheet.equal("section 3: ω_c of 30, 105, 385 rad/s", "5", three.divisor);
    sheet.equal(
        "section 3: m of 30, 105, 385 rad/s",
        ["6", "21", "77"],
        numbers(&three.multiples),
    );
    let verdict = |antisymmetric: bool| if antisymmetric { "has one" } else { "none" };
    let found = verdict(three.is_antisymmetric());
    sheet.claim(
        "section 3: antiperiod of 30, 105, 385 rad/s",
        "none",
        found.into(),
        found == "none",
    );
    minors(sheet, &three.multiples);

    let classes = partition(&[30.0, 105.0, 385.0])?;
    let last = classes.iter().find(|class| class.members == [1, 2]);
    let shared = last.is_some_and(|class| class.multiples.is_antisymmetric());
    sheet.claim(
        "section 3: modes 2 and 3 alone",
        "has one",
        verdict(shared).into(),
        shared,
    );
    let (divisor, multiples) = last.map_or((f64::NAN, Vec::new()), |class| {
        (class.multiples.divisor, numbers(&class.multiples.multiples))
    });
    sheet.equal("section 3: ω_c of modes 2 and 3", "35", divisor);
    sheet.equal("section 3: m of modes 2 and 3", ["3", "11"], multiples);
    sheet.formula("section 3: T_a of modes 2 and 3 in s: π/35", half(35.0), half(divisor));
    let modes = [30.0, 105.0, 385.0].map(|omega| mode_of_omega(omega, 0.0));
    let counts = [
        antisymmetric("two-impulse", &modes)?.len(),
        antisymmetric("three-impulse", &modes)?.len(),
        shaper(ShaperKind::Zv, &modes)?.impulses().len(),
        shaper(ShaperKind::Zvd, &modes)?.impulses().len(),
    ];
    sheet.equal(
        "section 3: impulses, two and three per set; classical",
        ["4", "9", "8", "27"],
        counts.map(|count| count as f64),
    );
    let (with, all) = odd_triples();
    sheet.refuted(
        "text: all m_i odd",
        "necessary, not sufficient",
        format!("{with} of {all} odd triples have an antiperiod"),
        with < all,
        "it is sufficient: with v_i = (m_i − 1)/2 every equation holds",
    );
    Ok(())
}

/// Returns how many triples of odd numbers up to 29 have an antiperiod, and how many triples there are. Independently
/// of the test itself, it checks that half the sum of a command and its copy `π` later is zero at every multiple.
fn odd_triples() -> (usize, usize) {
    let halves = [0.0, PI].map(|time_s| Impulse { time_s, amplitude: 0.5 });
    let odd = || (1..30).step_by(2);
    let triples = odd().flat_map(|a| odd().flat_map(move |b| odd().map(move |c| [a, b, c])));
    let triples: Vec<[u32; 3]> = triples.collect();
    let cancelled = |m: &u32| pole_sum(&halves, &mode_of_omega(f64::from(*m), 0.0), 0.0).norm() < 1e-12;
    let with = triples.iter().filter(|triple| triple.iter().all(cancelled)).count();
    (with, triples.len())
}

/// Adds the criterion by greatest common divisors of minors, for 30, 105, 385 rad/s.
fn minors(sheet: &mut Sheet, multiples: &[u64]) {
    let &[first, second, third] = multiples else { return };
    // m_j (2v_i + 1) = m_i (2v_j + 1), per pair of modes.
    let equation = |i: usize, j: usize, m_i: u64, m_j: u64| {
        let (m_i, m_j) = (m_i as i64, m_j as i64);
        let mut unknowns = [0; 3];
        unknowns[i] = 2 * m_j;
        unknowns[j] = -2 * m_i;
        Equation {
            unknowns,
            right: m_i - m_j,
        }
    };
    let pairs = [
        equation(0, 1, first, second),
        equation(0, 2, first, third),
        equation(1, 2, second, third),
    ];
    let divisors = |rows: &[usize]| {
        let equations: Vec<Equation> = rows.iter().map(|row| pairs[*row]).collect();
        [false, true].map(|augmented| minors_divisor(&equations, augmented) as f64)
    };
    sheet.equal(
        "section 3: gcd of minors, rows 1, 2, without and with right side",
        ["24", "12"],
        divisors(&[0, 1]),
    );
    for (rows, name) in [(&[0, 2][..], "1, 3"), (&[1, 2], "2, 3"), (&[0, 1, 2], "1, 2, 3")] {
        let [plain, augmented] = divisors(rows);
        sheet.by_rule(
            format!("section 3: ratio of the gcds, rows {name}"),
            "2",
            plain / augmented,
            Rule::Rounded,
            "other rows have other gcds and, as the paper says, the same conclusion",
        );
    }
}

/// Adds the rows of Table 1.
fn undamped(sheet: &mut Sheet) -> Result<(), DesignError> {
    let modes = example_modes(0.0);
    let sizes = |impulses: &[Impulse]| impulses.iter().map(|i| i.amplitude).collect::<Vec<_>>();
    sheet.equal(
        "Table 1: two impulses",
        [".5", ".5"],
        sizes(&antisymmetric("two-impulse", &modes)?),
    );
    sheet.equal(
        "Table 1: three impulses",
        [".25", ".5", ".25"],
        sizes(&antisymmetric("three-impulse", &modes)?),
    );
    let lowest_period_s = modes[0].damped_period_s();
    sheet.erratum(
        "section 4.1: T of 2 rad/s in s, printed as 2π/3",
        "2.0944",
        lowest_period_s,
        "2π/2 = π",
    );
    let two = antisymmetric("two-impulse", &modes)?;
    sheet.erratum(
        "text: time needed is at least the period of the lowest frequency, s",
        "3.1416",
        two.last().map_or(f64::NAN, |i| i.time_s),
        "half of it with two impulses, in the paper's own example",
    );
    Ok(())
}

/// Adds the rows of Table 2.
fn damped(sheet: &mut Sheet) -> Result<(), DesignError> {
    let modes = example_modes(DAMPING);
    let two = antisymmetric("two-impulse", &modes)?;
    let three = antisymmetric("three-impulse", &modes)?;
    let sizes = |impulses: &[Impulse]| impulses.iter().map(|i| i.amplitude).collect::<Vec<_>>();
    let of_two = sizes(&two);
    let first = of_two
        .first()
        .zip(of_two.last())
        .map_or(f64::NAN, |(first, last)| first / last);
    sheet.by_rule(
        "section 4.2: I1",
        "1.2144",
        first,
        Rule::Truncated,
        "truncated in print; 1.2145 rounded",
    );
    sheet.equal("Table 2: two impulses", [".5484", ".4516"], of_two);
    let times: Vec<f64> = three.iter().skip(1).map(|i| i.time_s).collect();
    sheet.equal("Table 2: times of three impulses in s", ["1.57", "3.14"], times);
    sheet.erratum(
        "Table 2: three impulses",
        [".30644", ".49482", ".19874"],
        sizes(&three),
        "they violate eq. (37) by 2.4 %; a solution of eqs (35) to (38) is ours",
    );
    let left = peak_ratio(&two, &modes);
    sheet.erratum(
        "text: vibration after two impulses, but for the sampling, of the unshaped",
        "0.00",
        left,
        "it is systematic: two impulses cannot serve two modes that decay differently",
    );
    Ok(())
}

/// Adds the rows of section 4.3: three impulses compared with the nine of the classical method.
fn effectiveness(sheet: &mut Sheet) -> Result<(), DesignError> {
    let modes = example_modes(DAMPING);
    let classical = shaper(ShaperKind::Zvd, &modes)?;
    sheet.equal(
        "section 4.3: impulses of the classical method",
        "9",
        amplitudes(&classical).len() as f64,
    );
    let nine: Vec<Impulse> = on_grid(amplitudes(&classical), &times_s(&classical));
    let three = on_grid(THREE_PRINTED.to_vec(), &[PI / 2.0, PI]);
    let nominal = [&three, &nine].map(|shaper| peak_ratio(shaper, &modes));
    sheet.claim(
        "text: three impulses are as effective as nine, 10 ms grid",
        "as effective",
        format!("they leave {:.4}, nine {:.4}", nominal[0], nominal[1]),
        nominal[0] <= nominal[1],
    );
    let off = modes.map(|mode| mode.scaled(1.02));
    let exact: Vec<Impulse> = classical.impulses().to_vec();
    let exact_three = with_times(THREE_PRINTED.to_vec(), &[PI / 2.0, PI]);
    let worse = [&exact_three, &exact].map(|shaper| residual_same_time(shaper, &off[1]));
    sheet.refuted(
        "text: three impulses are as effective as nine, frequencies 2 % off, mode 14",
        "as effective",
        format!("they leave {:.3}, nine {:.5}", worse[0], worse[1]),
        worse[0] <= worse[1],
        "an error of the frequency acts m times as much on an odd multiple m",
    );
    Ok(())
}

fn with_times(amplitudes: Vec<f64>, later_s: &[f64]) -> Vec<Impulse> {
    let times_s = std::iter::once(0.0).chain(later_s.iter().copied());
    let pairs = amplitudes.into_iter().zip(times_s);
    pairs.map(|(amplitude, time_s)| Impulse { time_s, amplitude }).collect()
}

/// Places the times at the nearest sample of the paper's simulations.
fn on_grid(amplitudes: Vec<f64>, later_s: &[f64]) -> Vec<Impulse> {
    let rounded: Vec<f64> = later_s
        .iter()
        .map(|time_s| (time_s / GRID_S).round() * GRID_S)
        .collect();
    with_times(amplitudes, &rounded)
}

/// Returns the amplitude left at a mode as a fraction of the unshaped one at the same time.
fn residual_same_time(impulses: &[Impulse], mode: &Mode) -> f64 {
    pole_sum(impulses, mode, 0.0).norm()
}

/// Returns the largest `|y|` after the last impulse divided by the largest unshaped one in the same time, where `y`
/// is the sum of both modes' impulse responses, of equal size.
fn peak_ratio(impulses: &[Impulse], modes: &[Mode]) -> f64 {
    const LOOKS: u32 = 10_000;
    const LOOK_S: f64 = 1e-3;
    let response = |impulses: &[Impulse], time_s: f64| -> f64 {
        let terms = modes.iter().flat_map(|mode| {
            impulses.iter().map(move |i| {
                let passed_s = time_s - i.time_s;
                i.amplitude * (-mode.decay() * passed_s).exp() * (mode.omega_damped() * passed_s).sin()
            })
        });
        terms.sum()
    };
    let start_s = impulses.last().map_or(0.0, |i| i.time_s);
    let unshaped = with_times(vec![1.0], &[]);
    let [shaped, unshaped] = [impulses, &unshaped].map(|impulses| {
        let looks = (0..LOOKS).map(|look| response(impulses, start_s + f64::from(look) * LOOK_S).abs());
        looks.fold(0.0, f64::max)
    });
    shaped / unshaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_peak_ratios_of_the_example() {
        let modes = example_modes(DAMPING);
        let two = antisymmetric("two-impulse", &modes).unwrap();
        assert!((peak_ratio(&two, &modes) - 0.055_302_5).abs() < 1e-5);
        let three = with_times(THREE_PRINTED.to_vec(), &[PI / 2.0, PI]);
        assert!((peak_ratio(&three, &modes) - 0.005_433_1).abs() < 1e-5);
        let nine = shaper(ShaperKind::Zvd, &modes).unwrap();
        let nine = on_grid(amplitudes(&nine), &times_s(&nine));
        assert!((peak_ratio(&nine, &modes) - 0.008_480_2).abs() < 1e-5);
    }
}
