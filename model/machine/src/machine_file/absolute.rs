//! The keys of `[axis.encoder]` with `kind = "ssi"` or `"biss_c"`: an absolute encoder.

use super::range::NumberRange;
use super::table::Table;
use super::{ClockSection, FixedPoint, LimitsSection};
use crate::unit::AxisUnit;
use posicast_blocks::absolute_encoder::{
    AbsoluteEncoderConfig, AbsoluteEncoderConfigError, AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes,
    AbsoluteTimesInSeconds, FrameCheck, FrameStatusBit, MOST_BISS_HZ, MOST_OTHER_BITS, MOST_TOLERATED, POSITION_BITS,
};
use posicast_blocks::axis::Cause;
use posicast_shaper::unit::{short, show_seconds};

/// Range of the line's clock.
pub(super) const LINE_HZ: NumberRange = NumberRange::positive(MOST_BISS_HZ).unit("Hz");
/// Range of times.
pub(super) const TIME_S: NumberRange = NumberRange::positive(1.0).unit("s");
/// Range of the cable's length.
pub(super) const CABLE_M: NumberRange = NumberRange::positive(2000.0).unit("m");
/// Bits of a position in all.
pub(super) const BITS: (u32, u32) = (1, *POSITION_BITS.end());
/// Most bits of turns.
pub(super) const TURNS_BITS: u32 = 32;
/// Most bits before and behind the position.
pub(super) const OTHER_BITS: u32 = MOST_OTHER_BITS;
/// Most readings in a row that may fail.
pub(super) const TOLERATED: u32 = MOST_TOLERATED as u32;
/// Readings in a row that may fail where the file does not say it.
pub(super) const DEFAULT_TOLERATED: u32 = 2;
/// Rest of the line between two readings where the file does not say it, s: most monoflops and time-outs are shorter.
pub(super) const DEFAULT_PAUSE_S: f64 = 25e-6;
/// Longest answer of BiSS-C where the file does not say it, s.
pub(super) const DEFAULT_ANSWER_S: f64 = 20e-6;

/// A reading may change by so many times what `limits.velocity` moves the axis in a tick.
const JUMP_FACTOR: f64 = 2.0;
/// And by so many counts more.
const JUMP_COUNTS: f64 = 8.0;
/// Delay of a line there and back, s per m of cable.
pub const CABLE_DELAY_S_PER_M: f64 = 10e-9;
/// Keys that only the protocol SSI has.
const OF_SSI: [&str; 6] = [
    "coding",
    "leading_bits",
    "trailing_bits",
    "error_bit",
    "error_level",
    "parity",
];

/// An absolute encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AbsoluteSection {
    /// How encoder and hardware talk.
    pub protocol: AbsoluteProtocol,
    /// The bits of a frame.
    pub frame: AbsoluteFrame,
    /// Fastest clock of the line, longest answer and shortest pause.
    pub times: AbsoluteTimesInSeconds,
    /// Readings in a row that may fail; the position is extrapolated over them.
    pub tolerated: u32,
    /// Reading at which the axis is at 0, modulo the encoder's range.
    pub offset: u32,
    /// Length of the cable in m, for a warning.
    pub cable_m: Option<f64>,
}

/// The codes of a position in SSI, with whether it is Gray code.
pub(super) const CODINGS: [(bool, &str); 2] = [(false, "binary"), (true, "gray")];
/// The levels of an error bit in SSI, with whether it is low at an error.
pub(super) const ERROR_LEVELS: [(bool, &str); 2] = [(true, "low"), (false, "high")];
/// The checks of a frame in SSI.
pub(super) const PARITIES: [(FrameCheck, &str); 3] = [
    (FrameCheck::None, "none"),
    (FrameCheck::EvenParity, "even"),
    (FrameCheck::OddParity, "odd"),
];

impl AbsoluteSection {
    /// The hardware that reads the encoder of an axis with this largest velocity in counts per s.
    ///
    /// # Errors
    /// [`AbsoluteEncoderConfigError`] for times and positions that do not fit its registers.
    pub fn hardware(
        &self,
        clock: &ClockSection,
        counts_per_s: f64,
    ) -> Result<AbsoluteEncoderConfig, AbsoluteEncoderConfigError> {
        let per_tick = counts_per_s * clock.sample_period_s();
        let limits = AbsoluteLimits {
            largest_jump: (JUMP_FACTOR * per_tick + JUMP_COUNTS).ceil() as u64,
            tolerated: self.tolerated.into(),
        };
        let times = AbsoluteTimes::from_seconds(self.times, self.protocol, clock.frequency_hz)?;
        AbsoluteEncoderConfig::new(self.protocol, self.frame, times, limits)
    }

    /// Half of the encoder's range in counts: its positions are from −half to half − 1 around the offset.
    pub fn half_range(&self) -> f64 {
        0.5 * f64::from(self.frame.position_bits).exp2()
    }
}

/// Reads the keys of an absolute encoder; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, protocol: AbsoluteProtocol) -> Option<AbsoluteSection> {
    let is_ssi = protocol == AbsoluteProtocol::Ssi;
    let name = protocol.name();
    for key in OF_SSI.into_iter().filter(|key| !is_ssi && table.has(key)) {
        let found = format!("{key} with kind = \"{name}\"");
        table.contradiction(
            key,
            found,
            format!("{key} with kind = \"ssi\""),
            format!("remove `{key}`"),
        );
    }
    if is_ssi && table.has("answer_s") {
        let allowed = "answer_s with kind = \"biss_c\": an encoder of SSI answers at once";
        table.contradiction("answer_s", "answer_s with kind = \"ssi\"", allowed, "remove `answer_s`");
    }
    table.require("bits", format!("a whole number, {} to {}", BITS.0, BITS.1));
    let bits = table.integer("bits", BITS.0, BITS.1);
    let turns_bits = table.integer("turns_bits", 0, TURNS_BITS).unwrap_or(0);
    let line_hz = table.required_number("clock_hz", LINE_HZ);
    let pause_s = table.number("pause_s", TIME_S).unwrap_or(DEFAULT_PAUSE_S);
    let answer_s = table.number("answer_s", TIME_S).unwrap_or(DEFAULT_ANSWER_S);
    let [leading_bits, trailing_bits] =
        ["leading_bits", "trailing_bits"].map(|key| table.integer(key, 0, OTHER_BITS).unwrap_or(0));
    let error = error_bit(table, trailing_bits);
    let gray = table.word("coding", &CODINGS).unwrap_or(false);
    let check = table.word("parity", &PARITIES).unwrap_or(FrameCheck::None);
    let tolerated = table.integer("tolerated", 0, TOLERATED).unwrap_or(DEFAULT_TOLERATED);
    let offset = table.integer("offset", 0, u32::MAX).unwrap_or(0);
    let cable_m = table.number("cable_m", CABLE_M);
    let position_bits = bits? + turns_bits;
    let frame = match protocol {
        AbsoluteProtocol::Ssi => AbsoluteFrame {
            leading_bits,
            trailing_bits,
            gray,
            check,
            error,
            ..AbsoluteFrame::ssi(position_bits)
        },
        AbsoluteProtocol::BissC => AbsoluteFrame::biss_c(position_bits),
    };
    Some(AbsoluteSection {
        protocol,
        frame,
        times: AbsoluteTimesInSeconds {
            line_hz: line_hz?,
            pause_s,
            answer_s,
        },
        tolerated,
        offset,
        cable_m,
    })
}

/// The trailing bit of SSI that shows an error.
fn error_bit(table: &Table<'_, '_>, trailing_bits: u32) -> Option<FrameStatusBit> {
    let active_low = table.word("error_level", &ERROR_LEVELS);
    if active_low.is_some() && !table.has("error_bit") {
        let found = format!("error_level = {} without error_bit", table.quote("error_level"));
        let allowed = "error_level beside error_bit, whose level it is";
        table.contradiction(
            "error_level",
            found,
            allowed,
            "add `error_bit`, or remove `error_level`",
        );
    }
    let bit = table.integer("error_bit", 1, OTHER_BITS)?;
    if bit > trailing_bits {
        let found = format!("error_bit = {bit} with trailing_bits = {trailing_bits}");
        let allowed = "one of the trailing bits, the first behind the position being 1";
        table.contradiction(
            "error_bit",
            found,
            allowed,
            "correct `error_bit`, or raise `trailing_bits`",
        );
        return None;
    }
    Some(FrameStatusBit {
        place: bit - 1,
        active_low: active_low.unwrap_or(false),
    })
}

/// The axis beside the table.
pub(super) struct OfAxis<'a> {
    pub(super) unit: AxisUnit,
    pub(super) counts_per_unit: Option<f64>,
    pub(super) limits: Option<&'a LimitsSection>,
    pub(super) clock: Option<ClockSection>,
    pub(super) fixed_point: Option<FixedPoint>,
    pub(super) modulo: bool,
}

/// Checks the encoder against clock, limits and counts of the axis.
pub(super) fn check(table: &Table<'_, '_>, encoder: &AbsoluteSection, axis: &OfAxis<'_>) {
    let Some(velocity) = axis.limits.and_then(|limits| limits.velocity) else {
        let allowed = "an absolute encoder with limits.velocity, by which a wrong reading is found";
        table.contradiction(
            "kind",
            format!("kind = {} without limits.velocity", table.quote("kind")),
            allowed,
            "add `velocity` to [axis.limits]",
        );
        return;
    };
    check_limits(table, axis.limits);
    let (Some(counts_per_unit), Some(clock)) = (axis.counts_per_unit, axis.clock) else {
        return;
    };
    check_range(table, encoder, axis, counts_per_unit);
    match encoder.hardware(&clock, velocity * counts_per_unit) {
        Err(error) => {
            let (key, remedy) = blamed(&error);
            let found = format!(
                "{key} = {}",
                if table.has(key) {
                    table.quote(key)
                } else {
                    "its default".to_owned()
                }
            );
            table.contradiction(key, found, error.to_string(), remedy);
        }
        Ok(hardware) => {
            let tick_clocks = u64::from(clock.clocks_per_sample());
            let clocks = hardware.least_tick_clocks();
            if clocks > tick_clocks {
                let found = format!(
                    "a reading of {} bits at {} Hz, which takes {} with its pause",
                    encoder.frame.bits(),
                    short(encoder.times.line_hz),
                    show_seconds(clocks as f64 / clock.frequency_hz, 4)
                );
                let allowed = format!(
                    "at most {}, a tick: each tick has a reading of its own",
                    show_seconds(clock.sample_period_s(), 4)
                );
                let times = match encoder.protocol {
                    AbsoluteProtocol::Ssi => "`pause_s`",
                    AbsoluteProtocol::BissC => "`pause_s` or `answer_s`",
                };
                let remedy = format!("raise `clock_hz`, lower {times}, or lower clock.sample_hz");
                table.contradiction("clock_hz", found, allowed, remedy);
            }
        }
    }
}

/// Checks the supervisor's settings: an absolute encoder needs no homing, and an axis that is lost must stand.
fn check_limits(table: &Table<'_, '_>, limits: Option<&LimitsSection>) {
    let Some(limits) = limits else {
        return;
    };
    let kind = table.quote("kind");
    if limits.soft_limits_after_homing {
        let found = format!("kind = {kind} with limits.soft_limits_after_homing");
        let allowed = "soft limits that act at once: an absolute encoder needs no homing";
        table.contradiction("kind", found, allowed, "remove `soft_limits_after_homing`");
    }
    if u32::from(limits.off_causes) & Cause::EncoderError.bit() == 0 {
        let cause = Cause::EncoderError.name();
        let found = format!("kind = {kind} with a list limits.off without \"{cause}\"");
        let allowed = format!(
            "\"{cause}\" in limits.off: while an absolute encoder is lost, its count stands and no loop can hold the axis"
        );
        table.contradiction("kind", found, allowed, format!("add \"{cause}\" to limits.off"));
    }
}

/// Checks that the encoder tells where the axis is after power-up, and that the position word holds it.
fn check_range(table: &Table<'_, '_>, encoder: &AbsoluteSection, axis: &OfAxis<'_>, counts_per_unit: f64) {
    let shown = |counts: f64| axis.unit.show(counts / counts_per_unit, 6);
    let half = encoder.half_range();
    let bits = encoder.frame.position_bits;
    let travel = axis.limits.and_then(|limits| limits.travel).filter(|_| !axis.modulo);
    if let Some([low, high]) = travel {
        let ends = [low, high].map(|end| end * counts_per_unit);
        if ends[0] < -half || ends[1] > half - 1.0 {
            let found = format!(
                "a position of {bits} bits, which tells {} to {} apart, with limits.travel from {} to {}",
                shown(-half),
                shown(half - 1.0),
                shown(ends[0]),
                shown(ends[1])
            );
            let allowed = "a range that has the whole travel: after power-up the axis may stand anywhere in it";
            let remedy = "raise `turns_bits`, or let the axis's zero and `offset` be in the middle of the travel";
            table.contradiction("bits", found, allowed, remedy);
        }
    } else if axis.modulo {
        let turn = counts_per_unit * std::f64::consts::TAU;
        if 2.0 * half < turn.round() {
            let found = format!(
                "a position of {bits} bits, {} counts, on an axis of {} per turn",
                short(2.0 * half),
                short(turn)
            );
            let allowed = "at least a turn of the axis: after power-up it may stand anywhere in it";
            table.contradiction("bits", found, allowed, "correct counts_per_unit, or raise `turns_bits`");
        }
    } else if let Some(format) = axis.fixed_point {
        let most = f64::from(format.command_bits - format.command_fraction - 1).exp2();
        if half > most {
            let found = format!(
                "a position of {bits} bits, ±{} counts, without limits.travel",
                short(half)
            );
            let allowed = format!("at most ±{} counts, which the position word holds", short(most - 1.0));
            table.contradiction(
                "bits",
                found,
                allowed,
                "add `travel` to [axis.limits]: only that must fit the word",
            );
        }
    }
}

/// The key to blame for an encoder that cannot be built, and the remedy.
fn blamed(error: &AbsoluteEncoderConfigError) -> (&'static str, &'static str) {
    use AbsoluteEncoderConfigError as Wrong;
    match error {
        Wrong::Clocks { name: "pause", .. } => ("pause_s", "take the time from the encoder's data sheet"),
        Wrong::Clocks { name: "answer", .. } => ("answer_s", "take the time from the encoder's data sheet"),
        Wrong::Clocks { .. } | Wrong::Number { .. } | Wrong::LineHz { .. } => ("clock_hz", "check its unit, Hz"),
        Wrong::Jump { .. } => (
            "bits",
            "correct `bits`, `turns_bits` or limits.velocity, or lower `tolerated`",
        ),
        Wrong::PositionBits(_)
        | Wrong::OtherBits { .. }
        | Wrong::StatusPlace { .. }
        | Wrong::BissCheck(_)
        | Wrong::Tolerated(_) => ("bits", "correct `bits` or `turns_bits`"),
    }
}
