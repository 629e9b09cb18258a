//! `[axis.shaper]`, and its checks against the modes' own `shaper` keys.

use super::ClockSection;
use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use posicast_optimal::{Command, Prefer};
use posicast_shaper::axis::{AxisMode, DEFAULT_EPSILON, DEFAULT_TOLERANCE, ShaperChoice, ShaperStructure};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::periodic::BASES;
use posicast_shaper::digitise::TAPS_MAX;
use posicast_shaper::unit::short;

/// Range of the residual that a shaper tolerates.
pub(super) const TOLERANCE: NumberRange = NumberRange::positive(1.0).open_above();
/// Range of the relative error of a frequency ratio.
const RATIO_TOLERANCE: NumberRange = NumberRange::closed(0.0, 1.0).open_above();
/// Range of the times of the impulses of `custom` in seconds, and of their amplitudes: what 18 bits hold.
const IMPULSE: NumberRange = NumberRange::closed(-65_535.0, 65_535.0);
/// Largest number of impulses of `custom`: each becomes at least one tap, and the largest table holds 256.
const MAX_IMPULSES: usize = 256;
/// Largest distance from 1 that the decimals of amplitudes may leave in their sum.
const SUM_ROUNDING: f64 = 1e-9;
/// Largest number of zero pairs, or of frequencies per mode.
const MAX_ORDER: u32 = 5;
/// Largest search limit of `periodic`, before it is compared with the sample rate.
const LOWEST_HZ: f64 = 1e9;
/// Amplitudes of `simultaneous`.
const AMPLITUDES: [&str; 2] = ["ps", "um"];
/// Methods of `antisymmetric`.
const METHODS: [&str; 3] = ["exact", "two-impulse", "three-impulse"];
/// Word for a command behind `optimal` without negative amplitudes.
const POSITIVE: &str = "positive";
/// Bounds of a shaped step, in steps.
const SUMS: NumberRange = NumberRange::closed(-1000.0, 1000.0);
/// Preferences of `optimal` among the shortest shapers.
const PREFERENCES: [(&str, Prefer); 3] = [
    ("fewest-taps", Prefer::FewestTaps),
    ("least-residual", Prefer::LeastResidual),
    ("least-delay", Prefer::LeastDelay),
];
const STRUCTURE: &str = "structure";
const COMMAND: &str = "command";
const AMPLITUDE_BOUNDS: &str = "amplitude_bounds";
const TAPS: &str = "taps";
const PREFER: &str = "prefer";
const IMPULSES: &str = "impulses";

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new("kind", Values::Word(all), "Kind of shaper.")
        .rule("one of the [kinds](shaper-design.md#the-kinds)")
        .required(),
    Key::new(
        "tolerance",
        Values::Number(TOLERANCE),
        "Residual of EI kinds at the mode; level at which insensitivity is measured.",
    )
    .default(Default::Number(DEFAULT_TOLERANCE)),
    Key::new(
        STRUCTURE,
        Values::Word(|| ShaperStructure::ALL.map(|(_, name)| name).to_vec()),
        "What computes the shaper: a table of taps, or half sums in series without a multiplier ([cascade](cascade.md)).",
    )
    .rule("`cascade` only where every mode's kind is `vibrationless`, in a machine of shapers alone, without `[stage]`")
    .default(Default::Word("taps")),
    ORDER,
    Key::new(
        "epsilon",
        Values::Number(TOLERANCE),
        "Bound of the residual of `vibrationless`.",
    )
    .rule("at least 1e-6, and for the orders 1 to 5 at most 0.5, 0.5, 0.38, 0.2, 0.06")
    .default(Default::Number(DEFAULT_EPSILON)),
    Key::new(
        "base",
        Values::Word(|| BASES.map(ShaperKind::name).to_vec()),
        "Shaper that `periodic` repeats.",
    )
    .default(Default::Word("multi-ei")),
    Key::new(
        "lowest_frequency_hz",
        Values::Number(NumberRange::positive(LOWEST_HZ).open_above()),
        "Lower end of the search of `periodic`. Absent: a tenth of the lowest mode's frequency.",
    )
    .rule("below half of `sample_hz`"),
    Key::new(
        "amplitude",
        Values::Word(|| AMPLITUDES.to_vec()),
        "Amplitudes of `simultaneous`: ps 1, −2, 2, …; um 1, −1, 1, ….",
    )
    .default(Default::Word("ps")),
    Key::new(
        "method",
        Values::Word(|| METHODS.to_vec()),
        "Solution method of `antisymmetric`.",
    )
    .default(Default::Word("exact")),
    Key::new(
        "ratio_tolerance",
        Values::Number(RATIO_TOLERANCE),
        "Relative error up to which `antisymmetric` takes a frequency ratio for odd.",
    )
    .default(Default::Number(0.0)),
    Key::new(
        COMMAND,
        Values::WordOrPair(|| vec![POSITIVE], SUMS),
        "Bounds of a step shaped by `optimal`: `positive` only rises; [low, high] are multiples of its height.",
    )
    .rule("`low` below `high`, `low` ≤ 1 ≤ `high`")
    .default(Default::Word(POSITIVE)),
    Key::new(
        AMPLITUDE_BOUNDS,
        Values::PlainPair(SUMS),
        "Bounds [low, high] of each amplitude of `optimal`, in place of `command`.",
    )
    .rule("`low` ≤ 0 < `high`"),
    Key::new(
        TAPS,
        Values::Integer(2, TAPS_MAX as u32),
        "Most taps of `optimal`, kept by a longer duration if necessary.",
    )
    .default(Default::Integer(TAPS_MAX as u32)),
    Key::new(
        PREFER,
        Values::Word(|| PREFERENCES.map(|(name, _)| name).to_vec()),
        "Choice of `optimal` among the shortest shapers.",
    )
    .default(Default::Word("fewest-taps")),
    Key::new(
        IMPULSES,
        Values::Pairs(IMPULSE, MAX_IMPULSES),
        "Impulses of `custom`, [time_s, amplitude], with times increasing from 0.",
    )
    .rule("amplitudes with sum 1, within 1e-9"),
];

/// The key `order`; a mode has it with a meaning of its own.
pub(super) const ORDER: Key = Key::new(
    "order",
    Values::Integer(1, MAX_ORDER),
    "Zero pairs of `chebyshev-ei`, also as `base` (default 3); frequencies per mode of `vibrationless` (default 2).",
);

/// Reads a kind of shaper by name.
pub(super) fn kind(table: &Table<'_, '_>, key: &str) -> Option<ShaperKind> {
    table.choice(key, &all()).and_then(ShaperKind::from_name)
}

/// Names of all kinds.
fn all() -> Vec<&'static str> {
    ShaperKind::ALL.iter().map(|kind| kind.name()).collect()
}

/// Names of the kinds that can serve a single mode.
pub(super) fn of_modes() -> Vec<&'static str> {
    let kinds = ShaperKind::ALL.iter().filter(|kind| !kind.treats_modes_together());
    kinds.map(|kind| kind.name()).collect()
}

/// Reads `order`.
pub(super) fn order(table: &Table<'_, '_>) -> Option<u32> {
    table.integer("order", 1, MAX_ORDER)
}

/// Reads `[axis.shaper]`.
pub(super) fn read(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<ShaperChoice> {
    table.allow(KEYS);
    table.require("kind", all().join(", "));
    let kind = kind(table, "kind");
    let half_sample_hz = clock.map_or(LOWEST_HZ, |c| c.sample_hz / 2.0);
    let lowest = NumberRange::positive(half_sample_hz).open_above().unit("Hz");
    let structure = table.word(STRUCTURE, &ShaperStructure::ALL);
    let (tolerance, order) = (table.number("tolerance", TOLERANCE), order(table));
    let epsilon = table.number("epsilon", TOLERANCE);
    let base = table
        .choice("base", &BASES.map(ShaperKind::name))
        .and_then(ShaperKind::from_name);
    let lowest_frequency_hz = table.number("lowest_frequency_hz", lowest);
    let amplitude = table.choice("amplitude", &AMPLITUDES).map(str::to_owned);
    let method = table.choice("method", &METHODS).map(str::to_owned);
    let ratio_tolerance = table.number("ratio_tolerance", RATIO_TOLERANCE);
    let command = read_command(table);
    let amplitudes = read_amplitude_bounds(table);
    let taps = table.integer(TAPS, 2, TAPS_MAX as u32);
    let prefer = table.choice(PREFER, &PREFERENCES.map(|(name, _)| name));
    let prefer = PREFERENCES.into_iter().find(|(name, _)| Some(*name) == prefer);
    let kind = kind?;
    Some(ShaperChoice {
        command: amplitudes.or(command),
        taps,
        prefer: prefer.map(|(_, prefer)| prefer),
        kind,
        structure: structure.unwrap_or_default(),
        tolerance,
        order,
        epsilon,
        base,
        lowest_frequency_hz,
        amplitude,
        method,
        ratio_tolerance,
        impulses: read_impulses(table, kind).unwrap_or_default(),
    })
}

/// `"positive"`, or the bounds of the partial sums; 1, where a step ends, lies within them.
fn read_command(table: &Table<'_, '_>) -> Option<Command> {
    if table.has_text(COMMAND) {
        return table.choice(COMMAND, &[POSITIVE]).map(|_| Command::Positive);
    }
    let [low, high] = table.numbers::<2>(COMMAND, SUMS)?;
    if low < high && low <= 1.0 && high >= 1.0 {
        return Some(Command::PartialSums { low, high });
    }
    let allowed = "[low, high] with low below high, low at most 1 and high at least 1, where a step ends";
    table.refuse(
        COMMAND,
        allowed,
        "such as `command = [-1, 1]`, or `command = \"positive\"`",
    );
    None
}

/// The bounds of each amplitude; 0 lies within them, because most samples have none.
fn read_amplitude_bounds(table: &Table<'_, '_>) -> Option<Command> {
    let [low, high] = table.numbers::<2>(AMPLITUDE_BOUNDS, SUMS)?;
    if table.has(COMMAND) {
        let found = format!("{AMPLITUDE_BOUNDS} beside {COMMAND}");
        let allowed = format!("one of {AMPLITUDE_BOUNDS} and {COMMAND}");
        let remedy = format!(
            "remove `{COMMAND}`; `{AMPLITUDE_BOUNDS} = [0, {}]` is a positive command too",
            short(high)
        );
        table.contradiction(AMPLITUDE_BOUNDS, found, allowed, remedy);
        return None;
    }
    if low <= 0.0 && high > 0.0 {
        return Some(Command::Amplitudes { low, high });
    }
    let allowed = "[low, high] with low at most 0 and high above 0";
    table.refuse(AMPLITUDE_BOUNDS, allowed, "such as `amplitude_bounds = [0, 0.3]`");
    None
}

fn read_impulses(table: &Table<'_, '_>, kind: ShaperKind) -> Option<Vec<(f64, f64)>> {
    let key = IMPULSES;
    if kind != ShaperKind::Custom {
        if table.has(key) {
            let found = format!("impulses with kind = \"{kind}\"");
            table.contradiction(
                key,
                found,
                "impulses with kind = \"custom\" only",
                "remove impulses, or set kind = \"custom\"",
            );
        }
        return None;
    }
    table.require(
        key,
        format_args!("a list of 1 to {MAX_IMPULSES} pairs [time_s, amplitude]"),
    );
    let rows = table.rows::<2>(key, IMPULSE, "time_s, amplitude", MAX_IMPULSES)?;
    let impulses: Vec<(f64, f64)> = rows
        .into_iter()
        .map(|[time_s, amplitude]| (time_s, amplitude))
        .collect();
    let first_s = impulses.first()?.0;
    if first_s != 0.0 {
        let found = format!("a first impulse at {} s", short(first_s));
        table.contradiction(
            key,
            found,
            "a first impulse at 0 s",
            format!("subtract {first_s} from all times"),
        );
    }
    if let Some(pair) = impulses.windows(2).find(|p| p[1].0 <= p[0].0) {
        let found = format!(
            "an impulse at {} s after one at {} s",
            short(pair[1].0),
            short(pair[0].0)
        );
        table.contradiction(
            key,
            found,
            "times that increase from impulse to impulse",
            "sort the impulses, add those at equal times",
        );
    }
    let sum: f64 = impulses.iter().map(|i| i.1).sum();
    if (sum - 1.0).abs() > SUM_ROUNDING {
        let found = format!("amplitudes with the sum {sum}");
        let allowed = format!("amplitudes with the sum 1, within {SUM_ROUNDING:e}");
        table.contradiction(key, found, allowed, format!("divide all amplitudes by {sum}"));
    }
    Some(impulses)
}

/// Checks an axis's shaper against its modes. Both come with their tables, which give the place of a problem.
pub(super) fn check(
    axis: &Table<'_, '_>,
    shaper: Option<&(Table<'_, '_>, ShaperChoice)>,
    modes: &[(Table<'_, '_>, AxisMode)],
    modulo: bool,
) {
    let kind = shaper.map(|(_, choice)| choice.kind);
    if axis.lacks("mode") && axis.lacks("mechanics") && kind.is_none_or(ShaperKind::depends_on_modes) {
        let allowed = "at least one [[axis.mode]], except with kind custom or none";
        let remedy = format!(
            "add [[axis.mode]] with frequency_hz and damping, or choose kind \"custom\" or \"none\"; {}",
            super::mode::MEASURE
        );
        axis.contradiction("mode", "an axis without modes", allowed, remedy);
    } else if kind.is_none() && axis.lacks("shaper") && modes.iter().any(|(_, mode)| mode.shaper.is_none()) {
        let found = "no [axis.shaper], and a mode without `shaper`";
        let allowed = "[axis.shaper], or `shaper` in every [[axis.mode]]";
        axis.contradiction(
            "shaper",
            found,
            allowed,
            "add [axis.shaper] with `kind = \"zvd\"`, or another kind, or give every mode a `shaper`",
        );
    }
    for (table, mode) in modes {
        check_own_shaper(table, kind, mode);
        let effective = mode.shaper.or(kind);
        if mode.order.is_some() {
            check_key(table, "order", effective.as_slice());
        }
    }
    if let Some((table, choice)) = shaper {
        let own_kinds = modes.iter().filter_map(|(_, mode)| mode.shaper);
        let used: Vec<ShaperKind> = own_kinds.chain([choice.kind]).collect();
        if choice.structure == ShaperStructure::Cascade {
            check_cascade(axis, table, modulo, &used);
        }
        // The base of `periodic` has the order of its own kind.
        let used: Vec<ShaperKind> = used.into_iter().chain(choice.base).collect();
        for key in KEYS {
            check_key(table, key.name, &used);
        }
    }
}

/// Tables of an axis that need taps: they hand over to another table, or shape in more than one channel.
const WITH_TAPS: [&str; 6] = ["family", "encoder", "pwm", "controller", "steps", "input"];

/// Checks that half sums can compute the axis.
fn check_cascade(axis: &Table<'_, '_>, table: &Table<'_, '_>, modulo: bool, used: &[ShaperKind]) {
    if let Some(other) = used.iter().find(|kind| **kind != ShaperKind::Vibrationless) {
        let found = format!("structure = \"cascade\" with kind {other}");
        let allowed = "a cascade with kind vibrationless, whose impulses are those of half sums";
        table.contradiction(
            STRUCTURE,
            found,
            allowed,
            "set `kind = \"vibrationless\"`, or remove `structure`",
        );
    }
    let needs_taps = WITH_TAPS.into_iter().find(|other| axis.has(other));
    if let Some(other) = needs_taps.or(modulo.then_some("modulo")) {
        let found = format!("structure = \"cascade\" on an axis with `{other}`");
        let allowed = "a cascade on an axis that has only a shaper: it has one channel, and its delays cannot be changed while it runs";
        table.contradiction(STRUCTURE, found, allowed, format!("remove `structure`, or `{other}`"));
    }
}

/// Checks a mode's own kind: it must serve a single mode, and the axis's kind must allow it.
fn check_own_shaper(table: &Table<'_, '_>, axis_kind: Option<ShaperKind>, mode: &AxisMode) {
    let Some(own) = mode.shaper else {
        return;
    };
    if own.treats_modes_together() {
        let found = format!("shaper = \"{own}\", which serves an axis and not one mode");
        let allowed = of_modes().join(", ");
        table.contradiction(
            "shaper",
            found,
            allowed,
            "set it as `kind` in [axis.shaper], or choose one of the list",
        );
        return;
    }
    match axis_kind.filter(|kind| kind.treats_modes_together()) {
        Some(ShaperKind::Simultaneous) if !matches!(own, ShaperKind::Zv | ShaperKind::Zvd) => {
            let found = format!("shaper = \"{own}\" under kind = \"simultaneous\"");
            table.contradiction("shaper", found, "zv, zvd", "choose one of the list");
        }
        Some(ShaperKind::Simultaneous) | None => {}
        Some(joint) => {
            let found = format!("shaper = \"{own}\" under kind = \"{joint}\", which would ignore it");
            let allowed = format!("no `shaper` in a mode under kind = \"{joint}\"");
            table.contradiction(
                "shaper",
                found,
                allowed,
                "remove `shaper` here, or remove [axis.shaper]",
            );
        }
    }
}

/// Checks that at least one of the kinds in use takes a key, if the key is present and only some kinds take it.
fn check_key(table: &Table<'_, '_>, key: &str, used: &[ShaperKind]) {
    let takers: Vec<ShaperKind> = ShaperKind::ALL.iter().copied().filter(|kind| kind.takes(key)).collect();
    // `read_impulses` has checked its key itself.
    let is_free = takers.is_empty() || key == IMPULSES;
    if !is_free && table.has(key) && !used.iter().any(|kind| takers.contains(kind)) {
        let [used, takers] =
            [used, &takers].map(|kinds| kinds.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", "));
        let found = format!("{key} with kind {used}");
        let allowed = format!("{key} with kind {takers}");
        table.contradiction(key, found, allowed, format!("remove `{key}`: it would have no effect"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_of_a_kind_are_keys_of_the_table() {
        for kind in ShaperKind::ALL {
            for key in kind.row().keys {
                assert!(KEYS.iter().any(|row| row.name == *key), "{key} of {kind}");
            }
        }
    }
}
