//! Finds the key of the machine file behind an impossible design, and the change that makes it possible.
//!
//! A shaper that is too long, or has too many taps, is designed again with one thing changed at a time: a lower
//! sample rate, a shorter kind of shaper, a lower order, another way of digitising. Changes that fit are proposed,
//! with their number of taps.

use crate::machine_file::{AxisSection, Machine};
use posicast_optimal::OptimalError;
use posicast_shaper::axis::ShaperStructure;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{DesignError, JointError, design_axis, optimal};
use posicast_shaper::digitise::Digitise;
use posicast_shaper::digitise::{DELAY_MAX_SAMPLES, DigitiseError, TAPS_MAX, digitise};
use posicast_shaper::mode::Mode;
use posicast_shaper::unit::{short, show_seconds};

/// A mode below this may be given in kHz.
const UNLIKELY_HZ: f64 = 1.0;
/// Only sample rates of at least this many samples per period of the fastest mode are proposed: below, its ringing is
/// hardly sampled.
const SAMPLES_PER_PERIOD: f64 = 8.0;
/// Largest number of sample rates that are tried; each is a design.
const MOST_RATES: usize = 24;
/// Kinds that are tried in place of a longer one, the most insensitive first.
const SHORTER_KINDS: [ShaperKind; 4] = [ShaperKind::TwoHumpEi, ShaperKind::Zvd, ShaperKind::Ei, ShaperKind::Zv];

/// The key to blame for a design that is impossible.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DesignBlame {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// Index of the mode, from 0, where the key belongs to a mode.
    pub mode: Option<usize>,
    /// The dotted key.
    pub key: String,
    /// A change that makes the design possible, where one was found.
    pub remedy: Option<String>,
}

/// Returns the key that causes a design error of this machine; `None` if the error does not concern one of its axes.
pub fn blame(machine: &Machine, error: &DesignError) -> Option<DesignBlame> {
    blame_modes(machine, error).map(|blame| as_written(machine, blame))
}

/// Replaces a mode's key by the key in the file: one of `[axis.mechanics]` if the mode is computed from it, or of
/// `[axis.shaper]` if that sets the tolerance.
fn as_written(machine: &Machine, blame: DesignBlame) -> DesignBlame {
    let axis = machine.axes.get(blame.axis);
    let is_computed = axis.is_some_and(|axis| axis.mechanics.is_some());
    let mode = axis.and_then(|axis| axis.modes.get(blame.mode?));
    let key = match blame.key.strip_prefix("axis.mode") {
        Some(".tolerance") if mode.is_some_and(|mode| mode.tolerance.is_none()) => "axis.shaper.tolerance",
        Some(".damping") if is_computed => "axis.mechanics.motor_held_damping",
        Some(".shaper" | ".frequency_band" | ".damping_band") if is_computed => "axis.shaper",
        Some(_) if is_computed => "axis.mechanics",
        _ => return blame,
    };
    DesignBlame {
        mode: None,
        key: key.to_owned(),
        ..blame
    }
}

fn blame_modes(machine: &Machine, error: &DesignError) -> Option<DesignBlame> {
    let of_axis = |name: &str| machine.axes.iter().position(|axis| axis.name == name);
    let shaper = |axis: usize| DesignBlame {
        axis,
        mode: None,
        key: "axis.shaper".to_owned(),
        remedy: None,
    };
    let at_mode = |mode: &Mode, key: &str| {
        let (axis, index) = place_of(machine, mode)?;
        Some(DesignBlame {
            mode: Some(index),
            key: format!("axis.mode.{key}"),
            ..shaper(axis)
        })
    };
    match error {
        DesignError::Table(DigitiseError::Taps { axis, .. }) | DesignError::TooManyImpulses { axis, .. } => {
            let axis = of_axis(axis)?;
            Some(DesignBlame {
                remedy: what_fits(machine, axis),
                ..shaper(axis)
            })
        }
        DesignError::Table(DigitiseError::Delay { axis, .. }) => too_long(machine, of_axis(axis)?),
        DesignError::Table(DigitiseError::Nyquist { axis, .. }) => Some(DesignBlame {
            key: "axis.mode".to_owned(),
            ..shaper(of_axis(axis)?)
        }),
        DesignError::Table(DigitiseError::MatchedDelay { axis, .. }) => Some(DesignBlame {
            key: "stage.extra_delay_s".to_owned(),
            ..shaper(of_axis(axis)?)
        }),
        DesignError::Table(DigitiseError::Fraction { .. } | DigitiseError::HalfSums { .. }) => Some(DesignBlame {
            key: "fixed_point.coefficient_fraction".to_owned(),
            ..shaper(0)
        }),
        DesignError::Table(
            DigitiseError::NoUnitSum { axis, .. }
            | DigitiseError::Weight { axis, .. }
            | DigitiseError::Table { axis, .. },
        )
        | DesignError::NoModes { axis, .. } => Some(shaper(of_axis(axis)?)),
        DesignError::JointOfAxis { axis, cause, .. } => {
            let axis = of_axis(axis)?;
            if let DesignError::Joint(JointError::Optimal(cause)) = cause.as_ref() {
                return Some(blame_optimal(machine, axis, cause));
            }
            let (mode, key) = match cause.as_ref() {
                DesignError::Joint(JointError::Coincident { second, .. }) => (second.checked_sub(1), "axis.mode"),
                DesignError::Joint(JointError::SearchRange { .. }) => (None, "axis.shaper.lowest_frequency_hz"),
                _ => (None, "axis.shaper"),
            };
            Some(DesignBlame {
                mode,
                key: key.to_owned(),
                ..shaper(axis)
            })
        }
        DesignError::FamilyGap { axis, .. } => Some(DesignBlame {
            key: "axis.family.values".to_owned(),
            remedy: Some("leave `values` out: posicast then makes as many tables as needed".to_owned()),
            ..shaper(of_axis(axis)?)
        }),
        DesignError::FamilySize { axis, .. } | DesignError::FamilyUncovered { axis, .. } => Some(DesignBlame {
            remedy: Some(
                "choose a kind with a wider insensitivity, such as \"ei\" or \"two-hump-ei\", or raise `tolerance`"
                    .to_owned(),
            ),
            ..shaper(of_axis(axis)?)
        }),
        DesignError::JointKindOfOneMode { mode, .. } => at_mode(mode, "shaper"),
        DesignError::Tolerance { mode, .. } => at_mode(mode, "tolerance"),
        DesignError::Mode { mode }
        | DesignError::Damping { mode, .. }
        | DesignError::NotSolved { mode, .. }
        | DesignError::NoSolution { mode, .. }
        | DesignError::Unverified { mode, .. } => at_mode(mode, "damping"),
        DesignError::OtherFamily { .. }
        | DesignError::BiasPoint { .. }
        | DesignError::NoSequence { .. }
        | DesignError::Joint(_) => None,
    }
}

/// Returns why `optimal` finds no shaper, and a remedy.
fn blame_optimal(machine: &Machine, axis: usize, error: &OptimalError) -> DesignBlame {
    let (mode, key, remedy) = match error {
        OptimalError::Band { band, .. } => (
            Some(*band),
            "axis.mode.frequency_band",
            "narrow the band, or raise clock.sample_hz".to_owned(),
        ),
        OptimalError::Tolerance { band, .. } => (
            Some(*band),
            "axis.mode.tolerance",
            "choose another tolerance".to_owned(),
        ),
        OptimalError::TooLong { .. } => {
            let slower = short(machine.clock.sample_hz / 2.0);
            let remedy = format!(
                "raise `tolerance`, narrow `frequency_band` and `damping_band`, allow `command = [-1, 1]`, or lower clock.sample_hz, for \
                 example to {slower}: the longest shaper then lasts twice as long"
            );
            (None, "axis.shaper", remedy)
        }
        OptimalError::Apart { .. } => (
            None,
            "axis.shaper",
            "remove `arrive_together` from [stage], which then delays the earlier axes".to_owned(),
        ),
        OptimalError::Amplitudes { samples, .. } => {
            let least = short(1.0 / f64::from(*samples));
            let remedy = format!("allow amplitudes of {least} or more: the sum must be 1");
            (None, "axis.shaper.amplitude_bounds", remedy)
        }
        OptimalError::TapBudget { fewest, .. } => {
            let remedy = format!("allow `taps = {fewest}`, raise `tolerance`, or narrow the bands");
            (None, "axis.shaper.taps", remedy)
        }
        OptimalError::Solver { .. } => (
            None,
            "axis.shaper",
            "raise a tolerance that is very small, or leave out a mode that is nearly another".to_owned(),
        ),
    };
    DesignBlame {
        axis,
        mode,
        key: key.to_owned(),
        remedy: Some(remedy),
    }
}

/// Axis and index of the first mode that is this one.
fn place_of(machine: &Machine, mode: &Mode) -> Option<(usize, usize)> {
    let axes = machine.axes.iter().enumerate();
    let mut places = axes.filter_map(|(axis, section)| {
        let index = section.modes.iter().position(|other| other.mode == *mode)?;
        Some((axis, index))
    });
    places.next()
}

/// Blames a shaper that lasts longer than any ring buffer on a mode that is far too slow, or on too high a sample
/// rate.
fn too_long(machine: &Machine, axis: usize) -> Option<DesignBlame> {
    let section = &machine.axes[axis];
    let slowest = section.modes.iter().enumerate();
    let slowest = slowest.min_by(|a, b| a.1.mode.frequency_hz.total_cmp(&b.1.mode.frequency_hz));
    let Some((index, mode)) = slowest.filter(|_| section.shaped().kind_name() != ShaperKind::Custom.name()) else {
        return Some(DesignBlame {
            axis,
            mode: None,
            key: "axis.shaper.impulses".to_owned(),
            remedy: rate_that_fits(machine, axis).map(|(text, _)| text),
        });
    };
    let hz = mode.mode.frequency_hz;
    let is_computed = section.mechanics.is_some();
    let of_mechanics = is_computed.then(|| {
        format!(
            "the mode computed from [axis.mechanics] is {} Hz: check the units, lengths in m, stiffness in N/m, inertia in kg·m², mass \
             in kg",
            short(hz)
        )
    });
    let in_khz = (!is_computed && hz < UNLIKELY_HZ && hz * 1e3 < machine.clock.sample_hz / 2.0)
        .then(|| format!("if it was meant in kHz, write `frequency_hz = {}`", short(hz * 1e3)));
    let rate = rate_that_fits(machine, axis).map(|(text, _)| match in_khz {
        // A crane or a telescope may really be this slow.
        Some(_) => format!("write `{text}`, at which the shaper fits"),
        None => text,
    });
    let period = in_khz.is_some().then(|| {
        let period_s = show_seconds(1.0 / hz, 3);
        format!("{} Hz is a period of {period_s}: ", short(hz))
    });
    let remedies: Vec<String> = [of_mechanics, rate, in_khz].into_iter().flatten().collect();
    let remedies = period.unwrap_or_default() + &remedies.join("; else ");
    Some(DesignBlame {
        axis,
        mode: Some(index),
        key: "axis.mode.frequency_hz".to_owned(),
        remedy: (!remedies.is_empty()).then_some(remedies),
    })
}

/// Returns the changes that reduce an axis with too many taps to the size of a table, each by itself.
fn what_fits(machine: &Machine, axis: usize) -> Option<String> {
    let section = &machine.axes[axis];
    if section.shaped().is_cascade() {
        return lower_order(machine, section).map(|(order, _)| format!("order = {order} fits a cascade"));
    }
    let mut found: Vec<String> = rate_that_fits(machine, axis)
        .map(|(text, taps)| format!("{text} ({taps} taps)"))
        .into_iter()
        .collect();
    if let Some((order, taps)) = lower_order(machine, section) {
        found.push(format!("order = {order} ({taps} taps)"));
    }
    let kind = SHORTER_KINDS.into_iter().find_map(|kind| {
        let changed = with_kind(section, kind)?;
        Some((kind, taps(&changed, machine.fixed_point.digitise, machine)?))
    });
    if let Some((kind, taps)) = kind {
        found.push(format!("kind = \"{kind}\" for all modes ({taps} taps)"));
    }
    if machine.fixed_point.digitise != Digitise::Nearest
        && let Some(taps) = taps(section, Digitise::Nearest, machine)
    {
        found.push(format!("digitise = \"nearest\" ({taps} taps)"));
    }
    let table = (!found.is_empty()).then(|| format!("each of these fits a table of {TAPS_MAX}: {}", found.join("; ")));
    let cascade = fits_as_cascade(machine, section)
        .then(|| "structure = \"cascade\" in [axis.shaper] computes it without a table".to_owned());
    let remedies: Vec<String> = cascade.into_iter().chain(table).collect();
    (!remedies.is_empty()).then(|| remedies.join("; else "))
}

/// Whether half sums can compute an axis that has a table now.
fn fits_as_cascade(machine: &Machine, section: &AxisSection) -> bool {
    let only_shapers = |axis: &AxisSection| !axis.has_loop() && axis.input.is_none();
    let mut changed = section.clone();
    let Some(shaper) = &mut changed.shaper else {
        return false;
    };
    shaper.structure = ShaperStructure::Cascade;
    section.shaped().is_vibrationless()
        && machine.stage.is_none()
        && machine.axes.iter().all(only_shapers)
        && !section.modulo
        && section.family.is_none()
        && taps(&changed, machine.fixed_point.digitise, machine).is_some()
}

/// The largest lower sample rate, in whole hertz, at which an axis has a table, with its number of taps.
fn rate_that_fits(machine: &Machine, axis: usize) -> Option<(String, usize)> {
    let section = &machine.axes[axis];
    let fastest_hz = section
        .modes
        .iter()
        .map(|mode| mode.mode.frequency_hz)
        .fold(0.0, f64::max);
    let duration_s = design_axis(section.shaped(), machine.clock.sample_hz)
        .ok()?
        .impulses
        .duration_s();
    let longest_hz = f64::from(DELAY_MAX_SAMPLES) / duration_s;
    let now = machine.clock.clocks_per_sample();
    let pwm = machine.axes.iter().filter_map(|axis| axis.pwm.as_ref());
    let pwm: Vec<f64> = pwm.map(|pwm| pwm.frequency_hz).collect();
    let rates = (now + 1..=1_000_000).map(|clocks| machine.clock.frequency_hz / f64::from(clocks));
    let rates = rates
        .filter(|hz| hz.fract() == 0.0 && *hz <= longest_hz && pwm.iter().all(|pwm| pwm % hz == 0.0))
        .take_while(|hz| *hz > SAMPLES_PER_PERIOD * fastest_hz);
    rates.take(MOST_RATES).find_map(|sample_hz| {
        let mut slower = machine.clone();
        slower.clock.sample_hz = sample_hz;
        let taps = taps(section, machine.fixed_point.digitise, &slower)?;
        Some((format!("clock.sample_hz = {sample_hz}"), taps))
    })
}

/// The largest lower order of the axis's shaper that fits, with its number of taps.
fn lower_order(machine: &Machine, section: &AxisSection) -> Option<(u32, usize)> {
    let order = section.modes.iter().map(|mode| section.shaped().order_of(mode)).max()?;
    (1..order).rev().find_map(|order| {
        let mut changed = section.clone();
        changed.shaper.as_mut()?.order = Some(order);
        changed.modes.iter_mut().for_each(|mode| mode.order = None);
        Some((order, taps(&changed, machine.fixed_point.digitise, machine)?))
    })
}

/// The axis with one kind for all its modes; `None` where it has that already, or has no modes.
fn with_kind(section: &AxisSection, kind: ShaperKind) -> Option<AxisSection> {
    let is_new = section.modes.iter().any(|mode| section.shaped().kind_of(mode) != kind);
    let mut changed = section.clone();
    changed.shaper.as_mut()?.kind = kind;
    changed.modes.iter_mut().for_each(|mode| mode.shaper = None);
    is_new.then_some(changed)
}

/// Number of taps of an axis at the machine's sample rate, if a table holds them.
fn taps(section: &AxisSection, how: Digitise, machine: &Machine) -> Option<usize> {
    let design = design_axis(section.shaped(), machine.clock.sample_hz).ok()?;
    let digitised = digitise(&design, how, machine.clock.sample_hz).ok()?;
    let tables = optimal::tables(&[(&design, &digitised)], machine.fixed_point.coefficient_fraction).ok()?;
    tables.first().map(|table| table.taps().len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine_file::parse;
    use crate::plan::design_machine;

    fn blamed(shaper: &str, modes: &[(f64, f64)]) -> DesignBlame {
        let modes: Vec<String> = modes
            .iter()
            .map(|(hz, damping)| format!("[[axis.mode]]\nfrequency_hz = {hz}\ndamping = {damping}\n"))
            .collect();
        let text = format!(
            "name = \"m\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n[[axis]]\nname = \"x\"\n\
             counts_per_unit = 1000\n[axis.shaper]\n{shaper}\n{}",
            modes.concat()
        );
        let machine = parse("m.toml", &text).unwrap();
        blame(&machine, &design_machine(&machine).unwrap_err()).unwrap()
    }

    #[test]
    fn a_mode_in_kilohertz_is_asked_for() {
        let blame = blamed("kind = \"zvd\"", &[(100.0, 0.1), (0.03, 0.1)]);
        assert_eq!((blame.mode, blame.key.as_str()), (Some(1), "axis.mode.frequency_hz"));
        let remedy = blame.remedy.unwrap();
        assert_eq!(
            remedy,
            "0.03 Hz is a period of 33.3 s: if it was meant in kHz, write `frequency_hz = 30`"
        );
    }

    #[test]
    fn a_very_slow_mode_is_first_advised_a_sample_rate() {
        let blame = blamed("kind = \"zvd\"", &[(0.16, 0.01)]);
        let remedy = blame.remedy.unwrap();
        assert!(
            remedy.starts_with("0.16 Hz is a period of 6.25 s: write `clock.sample_hz = "),
            "{remedy}"
        );
        assert!(
            remedy.ends_with("; else if it was meant in kHz, write `frequency_hz = 160`"),
            "{remedy}"
        );
    }

    #[test]
    fn too_many_taps_get_changes_that_fit() {
        let modes = [(20.0, 0.1), (31.0, 0.1), (47.0, 0.05)];
        let blame = blamed("kind = \"three-hump-ei\"", &modes);
        assert_eq!(blame.key, "axis.shaper");
        let remedy = blame.remedy.unwrap();
        for change in ["clock.sample_hz = ", "kind = \"two-hump-ei\"", "digitise = \"nearest\""] {
            assert!(remedy.contains(change), "{remedy}");
        }
        let blame = blamed("kind = \"chebyshev-ei\"\norder = 5", &modes[..2]);
        assert!(blame.remedy.is_some_and(|remedy| remedy.contains("order = ")));
    }

    #[test]
    fn a_damping_that_a_kind_does_not_take_is_blamed_on_its_mode() {
        let blame = blamed("kind = \"ps-zv\"", &[(50.0, 0.1), (80.0, 0.6)]);
        assert_eq!((blame.mode, blame.key.as_str()), (Some(1), "axis.mode.damping"));
    }
}
