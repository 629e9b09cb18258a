//! "hybrid-ei": bias-point hybrids of ZV and EI, and one of them repeated over four modes (Zhang and Li 2010).
//!
//! Everything is undamped and for a tolerance of 5 % unless an item says otherwise; `T = π/ω_sys`.

use super::chain::Chain;
use super::designs::{amplitudes, hybrid, mode_of_omega, shaper};
use super::sheet::{Rule, Sheet};
use posicast_shaper::analysis::residual_vibration;
use posicast_shaper::design::DesignError;
use posicast_shaper::design::bias_point::{self, BiasPoint};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::periodic;
use posicast_shaper::impulse::{Impulse, ImpulseSequence};
use std::f64::consts::PI;

const TOLERANCE: f64 = 0.05;

/// The columns of Table 1: name and kind (Zvd stands for ZVD).
pub(super) const TABLE_1: [(&str, ShaperKind); 5] = [
    ("ZVD", ShaperKind::Zvd),
    ("EI", ShaperKind::ZvEi),
    ("ZV-EI", ShaperKind::ZvEi2),
    ("Multi-EI", ShaperKind::MultiEi),
    ("ZVD-EI", ShaperKind::ZvdEi),
];

/// The modes of the four-mode example in rad/s.
const OMEGAS: [f64; 4] = [10.0, 35.0, 68.0, 124.0];
/// Lowest `ω_sys` that is searched, in rad/s.
const LOWEST: f64 = 1.0;

fn base(kind: ShaperKind) -> Result<BiasPoint, DesignError> {
    bias_point::undamped(kind, 1, TOLERANCE)
}

/// Returns the one-sided relative width at 5 %.
fn lambda(kind: ShaperKind) -> Result<f64, DesignError> {
    match kind {
        // V = cos²(ωT/2)
        ShaperKind::Zvd => Ok(2.0 / PI * TOLERANCE.sqrt().asin()),
        _ => base(kind).map(|b| b.lambda),
    }
}

pub(super) fn rows(sheet: &mut Sheet) -> Result<(), DesignError> {
    single_hybrids(sheet)?;
    multi(sheet)?;
    widths(sheet)?;
    sensitivities(sheet)?;
    intersections(sheet)?;
    four_modes(sheet)
}

/// Adds the rows of equations (6) to (20).
fn single_hybrids(sheet: &mut Sheet) -> Result<(), DesignError> {
    let ei = base(ShaperKind::ZvEi)?;
    sheet.equal(
        "eqs (6), (7): amplitudes of ZV-EI",
        [".2625", ".475", ".2625"],
        ei.amplitudes.clone(),
    );
    constant_for_impulse(sheet, "eq (7): first term of H(t)", "0.2625", ei.amplitudes.first());
    sheet.equal("eq (8): λ of ZV-EI", ".1997", ei.lambda);
    let root = TOLERANCE.sqrt();
    let k = (1.0 - root) / (1.0 + root);
    let scale = (1.0 + root) * (1.0 + root) / 16.0;
    let second = base(ShaperKind::ZvEi2)?;
    sheet.formula(
        "eq (20): amplitudes of the second-order ZV-EI",
        [1.0, 4.0 * k, 2.0 + 4.0 * k * k, 4.0 * k, 1.0].map(|a| scale * a),
        second.amplitudes,
    );
    let mode = mode_of_omega(20.0, 0.0);
    let left = residual_vibration(shaper(ShaperKind::ZvEi2, &[mode])?.impulses(), &mode);
    sheet.equal("eq (20): residual at ω_sys", ".05", left);
    Ok(())
}

/// Adds an erratum: the paper writes a constant where an impulse belongs.
fn constant_for_impulse(sheet: &mut Sheet, item: &str, paper: &str, amplitude: Option<&f64>) {
    let ours = amplitude.map_or_else(String::new, |a| format!("{a:.4} δ(t)"));
    let reason = "the first impulse is at t = 0, not a constant for all time";
    sheet.refuted(item, paper, ours.clone(), ours == paper, reason);
}

/// Adds the rows of equations (23) to (27): Multi-EI.
fn multi(sheet: &mut Sheet) -> Result<(), DesignError> {
    let multi = base(ShaperKind::MultiEi)?;
    // Zeros at θ = (1 − α)π: x = cos απ = −cos θ.
    let mut cosines: Vec<f64> = multi.zeros_theta.iter().map(|theta| -theta.cos()).collect();
    cosines.sort_by(|a, b| b.total_cmp(a));
    let alphas: Vec<f64> = cosines.iter().map(|c| c.acos() / PI).collect();
    let thetas: Vec<f64> = alphas.iter().map(|alpha| 1.0 - alpha).collect();
    let y = cosines.last().copied().unwrap_or(f64::NAN);
    let (w, v) = ((1.0 - y) / (1.0 + y), TOLERANCE);
    let polynomial = w.powi(4) - 4.0 * v * w.powi(3) - (6.0 * v + 4.0 * v * v) * w * w - 4.0 * v * v * w + v * v;
    sheet.formula("eq (25): its polynomial at our zero", 0.0, polynomial);
    sheet.equal("eqs (24), (25): x, y", [".8619", ".1948"], cosines);
    sheet.equal("eq (25): α, β", [".1693", ".4376"], alphas);
    sheet.equal("eq (26): θ/π of the zeros", [".8307", ".5624"], thetas);
    sheet.equal(
        "eq (26): amplitudes of Multi-EI",
        [".1124", ".2375", ".3002", ".2375", ".1124"],
        multi.amplitudes.clone(),
    );
    constant_for_impulse(sheet, "eq (26): first term of H(t)", "0.1124", multi.amplitudes.first());
    sheet.equal("eq (27): cosine of the edge", ".0567", (PI * multi.lambda).cos());

    let wide = bias_point::undamped(ShaperKind::MultiEi, 1, 0.1)?;
    let alpha = |theta: &f64| 1.0 - theta / PI;
    let beta = wide.zeros_theta.iter().map(alpha).fold(0.0, f64::max);
    let least = wide.amplitudes.iter().copied().fold(f64::INFINITY, f64::min);
    sheet.refuted(
        "eq (23): positive amplitudes need β < 1/2; at V = 0.1",
        "needed",
        format!("β = {beta:.4}, smallest amplitude {least:.4}"),
        !(beta > 0.5 && least > 0.0),
        "sufficient, not necessary: test the amplitudes themselves",
    );
    Ok(())
}

/// Adds the rows of Table 1.
fn widths(sheet: &mut Sheet) -> Result<(), DesignError> {
    const PRINTED: [&str; 5] = ["14.36", "19.97", "41.33", "48.2", "59.17"];
    let mut widest = 0.0f64;
    for ((name, kind), printed) in TABLE_1.into_iter().zip(PRINTED) {
        let lambda = lambda(kind)?;
        widest = widest.max(2.0 * lambda);
        sheet.equal(
            format!("Table 1: one-sided width of {name}, %"),
            printed,
            100.0 * lambda,
        );
    }
    let of_multi = 100.0 * lambda(ShaperKind::MultiEi)?;
    sheet.erratum(
        "text: one-sided width of Multi-EI, %",
        "48.4",
        of_multi,
        "contradicts Table 1 and λ = .4819",
    );
    sheet.exceeded(
        "text: no 2λ exceeds",
        "1",
        widest,
        "ZVD-EI, in Table 1 itself, has 1.183",
    );
    Ok(())
}

/// Adds the rows of Table 2: residuals of ZVD, EI and Multi-EI for `ω_sys = 20 rad/s`.
fn sensitivities(sheet: &mut Sheet) -> Result<(), DesignError> {
    const SYSTEM: f64 = 20.0;
    const KINDS: [(&str, ShaperKind); 3] = [
        ("ZVD", ShaperKind::Zvd),
        ("EI", ShaperKind::ZvEi),
        ("Multi-EI", ShaperKind::MultiEi),
    ];
    // A frequency, then per shaper the printed percentage and whether it is right.
    type Line = (f64, [(&'static str, bool); 3]);
    const TABLE_2: [Line; 5] = [
        (10.36, [("47", true), ("42", false), ("5", true)]),
        (11.248, [("40", true), ("37", true), ("0", true)]),
        (16.614, [("6.4", false), ("2.3", true), ("0", true)]),
        (17.2, [("3.8", false), ("0", true), ("1.2", false)]),
        (20.0, [("0", true), ("5", true), ("5", true)]),
    ];
    let mode = mode_of_omega(SYSTEM, 0.0);
    let shapers = KINDS.map(|(_, kind)| shaper(kind, &[mode]));
    for (omega, line) in TABLE_2 {
        for (((name, _), designed), (printed, right)) in KINDS.iter().zip(&shapers).zip(line) {
            let designed = designed.as_ref().map_err(Clone::clone)?;
            let left = 100.0 * residual_vibration(designed.impulses(), &mode_of_omega(omega, 0.0));
            let item = format!("Table 2: residual of {name} at {omega} rad/s, %");
            if right {
                sheet.equal(item, printed, left)
            } else {
                sheet.erratum(item, printed, left, "the paper's own formula gives ours; a misprint")
            }
        }
    }
    let multi = base(ShaperKind::MultiEi)?;
    let zero = multi.zeros_theta.iter().fold(0.0, |most: f64, theta| most.max(*theta)) / PI * SYSTEM;
    sheet.erratum(
        "Table 2: label of row 3 in rad/s",
        "16.624",
        zero,
        "the zero of Multi-EI; its printed mirror agrees",
    );
    sheet.equal("Table 2: mirror of row 3 in rad/s", "23.386", 2.0 * SYSTEM - zero);
    let mirror = 2.0 * SYSTEM - 17.2;
    sheet.erratum(
        "Table 2: mirror of row 4, 17.2 rad/s",
        "20.28",
        mirror,
        "residuals repeat at 2·20 − ω",
    );
    Ok(())
}

/// Adds the rows of section 3.2: one shaper for four modes.
fn intersections(sheet: &mut Sheet) -> Result<(), DesignError> {
    let search = |lambda: f64| periodic::search(&OMEGAS, lambda, LOWEST).map_err(DesignError::from);
    let solutions = search(0.4819)?;
    let none = periodic::Solution {
        low_hz: f64::NAN,
        high_hz: f64::NAN,
        n: Vec::new(),
    };
    let [first, second] = [0, 1].map(|k| solutions.get(k).unwrap_or(&none));
    let multiples = |solution: &periodic::Solution| solution.n.iter().map(|n| f64::from(*n)).collect::<Vec<_>>();
    sheet.equal(
        "section 3.2: first interval of ω_sys in rad/s, λ = .4819",
        ["13.0775", "13.8994"],
        [first.low_hz, first.high_hz],
    );
    sheet.equal(
        "section 3.2: n of the first interval",
        ["0", "1", "2", "4"],
        multiples(first),
    );
    sheet.equal(
        "section 3.2: second interval of ω_sys in rad/s",
        ["7.1716", "7.5069"],
        [second.low_hz, second.high_hz],
    );
    sheet.erratum(
        "section 3.2: n of the second interval",
        ["0", "3", "4", "8"],
        multiples(second),
        "with n2 = 3 mode 2 allows 4.678 to 5.370 rad/s only, outside the interval",
    );
    let with_zero = solutions.iter().filter(|s| s.n.first() == Some(&0)).count();
    sheet.equal("section 3.2: solutions with n1 = 0", "2", with_zero as f64);
    let of_ei = search(0.1997)?;
    let small = of_ei.iter().filter(|s| s.n.first().is_some_and(|n| *n <= 1)).count();
    sheet.equal(
        "section 3.2: solutions of EI (λ = .1997) with n1 = 0 or 1",
        "0",
        small as f64,
    );
    sheet.erratum(
        "text: solutions for a smaller tolerance (EI) above 1 rad/s",
        "0",
        of_ei.len() as f64,
        "EI has solutions, only slow ones: 1.393 rad/s at most",
    );
    Ok(())
}

/// Adds the rows of section 4: the chosen shaper and the cascade on the four-mode plant.
fn four_modes(sheet: &mut Sheet) -> Result<(), DesignError> {
    let cascade = hybrid(&OMEGAS.map(|omega| (ShaperKind::ZvEi, mode_of_omega(omega, 0.0))))?;
    sheet.by_rule(
        "text: duration of the EI cascade is 4π over, rad/s",
        "13.22",
        4.0 * PI / cascade.duration_s(),
        Rule::RoundedUp,
        "rounded up in print",
    );
    let chosen = shaper(ShaperKind::MultiEi, &[mode_of_omega(13.5, 0.0)])?;
    let counts = [cascade.impulses().len() as f64, amplitudes(&chosen).len() as f64];
    sheet.equal("text: impulses of the EI cascade and of Multi-EI", ["81", "5"], counts);
    for (damping, note) in [
        (0.0, "largest deviation in 60 s after the last impulse"),
        (
            0.01,
            "holds for the sum; alone, modes 3 and 4 exceed 5 %, but they are 1 % of the motion",
        ),
    ] {
        sheet.by_rule(
            format!("section 4: vibration after the last impulse, δ = {damping}, % of the step"),
            "5",
            100.0 * four_mode_deviation(&chosen, damping),
            Rule::AtMost,
            note,
        );
    }
    Ok(())
}

/// Returns the largest deviation from the step after the last impulse of `shaper`, as a fraction of the step.
fn four_mode_deviation(shaper: &ImpulseSequence, damping: f64) -> f64 {
    const LOOKS: u32 = 120_000;
    const LOOK_S: f64 = 5e-4;
    let chain = Chain::new(&OMEGAS.map(|omega| mode_of_omega(omega, damping)));
    let impulses: &[Impulse] = shaper.impulses();
    let start_s = shaper.duration_s();
    let looks = (0..LOOKS).map(|look| chain.vibration(impulses, start_s + f64::from(look) * LOOK_S).abs());
    looks.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_four_mode_plant() {
        let chosen = shaper(ShaperKind::MultiEi, &[mode_of_omega(13.5, 0.0)]).unwrap();
        for (damping, expected) in [(0.0, 0.047_037_967_865_039_4), (0.01, 0.043_928_023_015_192_79)] {
            let found = four_mode_deviation(&chosen, damping);
            assert!((found - expected).abs() < 1e-6, "{found}");
        }
    }
}
