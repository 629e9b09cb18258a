//! `[axis.encoder]`: what the axis's position is read from: A, B and index, or an absolute encoder.

use super::absolute::{
    self, AbsoluteSection, BITS, CABLE_M, CODINGS, DEFAULT_ANSWER_S, DEFAULT_PAUSE_S, DEFAULT_TOLERATED, ERROR_LEVELS,
    LINE_HZ, OTHER_BITS, PARITIES, TIME_S, TOLERATED, TURNS_BITS,
};
use super::key::{Default, Key, Values};
use super::table::Table;
use posicast_blocks::absolute_encoder::AbsoluteProtocol;
use posicast_blocks::pulse_counter::FILTER_CLOCKS_MAX;

/// `[axis.encoder]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoder {
    /// Pulses of up to this many clocks are ignored: 0 (the default, no filter) to [`FILTER_CLOCKS_MAX`]. Without a
    /// filter every level counts that two flip-flops see.
    pub filter_clocks: u32,
    /// Whether the encoder has an index line. Default: false.
    pub index: bool,
    /// Whether the lines count down where the drive's positive command moves up. Default: false.
    pub invert: bool,
    /// An absolute encoder, which has neither filter nor index.
    pub absolute: Option<AbsoluteSection>,
}

/// Kinds of encoders with their names in the machine file.
const KINDS: [(Option<AbsoluteProtocol>, &str); 3] = [
    (None, "quadrature"),
    (Some(AbsoluteProtocol::Ssi), "ssi"),
    (Some(AbsoluteProtocol::BissC), "biss_c"),
];

/// Keys that only an encoder with A, B and index has.
const OF_QUADRATURE: [&str; 2] = ["filter_clocks", "index"];
/// Keys that only an absolute encoder has.
const OF_ABSOLUTE: [&str; 14] = [
    "bits",
    "turns_bits",
    "clock_hz",
    "pause_s",
    "answer_s",
    "coding",
    "leading_bits",
    "trailing_bits",
    "error_bit",
    "error_level",
    "parity",
    "tolerated",
    "offset",
    "cable_m",
];

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "kind",
        Values::Word(|| KINDS.map(|(_, name)| name).to_vec()),
        "Signals of the encoder: A, B and index, or an absolute position over SSI or BiSS-C.",
    )
    .default(Default::Word("quadrature")),
    Key::switch(
        "invert",
        "The encoder counts down where a positive command moves the axis up.",
    ),
    Key::new(
        "filter_clocks",
        Values::Integer(0, FILTER_CLOCKS_MAX),
        "Longest ignored pulse on every line. 0: no filter.",
    )
    .default(Default::Integer(0))
    .rule("only `quadrature`"),
    Key::switch("index", "The simulated encoder has an index line.").rule("only `quadrature`"),
    Key::new(
        "bits",
        Values::Integer(BITS.0, BITS.1),
        "Bits of the position, in a turn or in all. `ssi` and `biss_c` need it.",
    )
    .rule("with `turns_bits` 8 to 40"),
    Key::new(
        "turns_bits",
        Values::Integer(0, TURNS_BITS),
        "Bits that count turns, before those of the position.",
    )
    .default(Default::Integer(0)),
    Key::new(
        "clock_hz",
        Values::Number(LINE_HZ),
        "Fastest clock of the line; the hardware's is a whole number of clocks per half period. `ssi` and `biss_c` need it.",
    )
    .rule("`ssi` up to 2 MHz; a reading and its pause fit into a tick"),
    Key::new(
        "pause_s",
        Values::Number(TIME_S),
        "Rest of the line between two readings: longer than monoflop time or time-out, and the delay of the line.",
    )
    .default(Default::Number(DEFAULT_PAUSE_S)),
    Key::new(
        "answer_s",
        Values::Number(TIME_S),
        "Longest time until the frame begins: a few periods, the delay of the line, and the time that the encoder takes.",
    )
    .default(Default::Number(DEFAULT_ANSWER_S))
    .rule("only `biss_c`"),
    Key::new(
        "coding",
        Values::Word(|| CODINGS.map(|(_, name)| name).to_vec()),
        "Code of the position.",
    )
    .default(Default::Word("binary"))
    .rule("only `ssi`"),
    Key::new(
        "leading_bits",
        Values::Integer(0, OTHER_BITS),
        "Bits before the position, without meaning.",
    )
    .default(Default::Integer(0))
    .rule("only `ssi`"),
    Key::new(
        "trailing_bits",
        Values::Integer(0, OTHER_BITS),
        "Bits behind the position; without meaning, but for `error_bit`.",
    )
    .default(Default::Integer(0))
    .rule("only `ssi`"),
    Key::new(
        "error_bit",
        Values::Integer(1, OTHER_BITS),
        "Which of the trailing bits shows that the position is wrong, the first behind it being 1; such a reading fails.",
    )
    .rule("only `ssi`; at most `trailing_bits`"),
    Key::new(
        "error_level",
        Values::Word(|| ERROR_LEVELS.map(|(_, name)| name).to_vec()),
        "Level of `error_bit` at an error.",
    )
    .default(Default::Word("high"))
    .rule("only beside `error_bit`"),
    Key::new(
        "parity",
        Values::Word(|| PARITIES.map(|(_, name)| name).to_vec()),
        "Parity bit at the end of the frame.",
    )
    .default(Default::Word("none"))
    .rule("only `ssi`"),
    Key::new(
        "tolerated",
        Values::Integer(0, TOLERATED),
        "Failed readings in a row over which the position is extrapolated; one more is the cause `encoder-error`.",
    )
    .default(Default::Integer(DEFAULT_TOLERATED)),
    Key::new(
        "offset",
        Values::Integer(0, u32::MAX),
        "Reading at which the axis is at 0.",
    )
    .default(Default::Integer(0)),
    Key::new(
        "cable_m",
        Values::Number(CABLE_M),
        "Length of the cable, for a warning where `clock_hz` is too fast for it.",
    ),
];

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>) -> Option<Encoder> {
    table.allow(KEYS);
    let kind = if table.has("kind") {
        table.word("kind", &KINDS)?
    } else {
        None
    };
    let (foreign, allowed): (&[&str], _) = match kind {
        None => (&OF_ABSOLUTE, "with kind = \"ssi\" or \"biss_c\", an absolute encoder"),
        Some(_) => (
            &OF_QUADRATURE,
            "with kind = \"quadrature\", which has lines A, B and index",
        ),
    };
    let found = |key: &&&str| table.has(key);
    if let Some(key) = foreign.iter().find(found) {
        let name = KINDS.iter().find(|(of, _)| *of == kind).map_or("", |(_, name)| name);
        let found = format!("{key} with kind = \"{name}\"");
        table.contradiction(
            key,
            found,
            format!("{key} {allowed}"),
            format!("remove `{key}`, or change `kind`"),
        );
        return None;
    }
    let filter_clocks = if table.has("filter_clocks") {
        table.integer("filter_clocks", 0, FILTER_CLOCKS_MAX)?
    } else {
        0
    };
    let absolute = match kind {
        Some(protocol) => Some(absolute::read(table, protocol)?),
        None => None,
    };
    Some(Encoder {
        filter_clocks,
        index: table.boolean("index").unwrap_or(false),
        invert: table.boolean("invert").unwrap_or(false),
        absolute,
    })
}
