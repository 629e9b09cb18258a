//! The ports of the PWM.

use super::TIME_BITS;
use crate::rtl::{Direction, Port};

/// What the four pins do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Mode {
    /// `a_high` is the PWM of |duty|, `b_high` its direction (on is negative); the others are off.
    #[default]
    Direction,
    /// Leg A switches with a duty from 0; leg B is off.
    HalfBridge,
    /// One leg switches with |duty|, the other stays on its low side: A for positive duty, B for negative.
    Unipolar,
    /// A's high side and B's low side switch together, against the other two: duty 0 is 50 %.
    Locked,
}

impl Mode {
    /// From the register's value, 2 bits.
    #[inline]
    pub fn from_register(value: u8) -> Self {
        match value & 3 {
            0 => Self::Direction,
            1 => Self::HalfBridge,
            2 => Self::Unipolar,
            _ => Self::Locked,
        }
    }

    /// Whether the sign of the duty is a direction that is switched.
    pub(super) fn has_direction(self) -> bool {
        matches!(self, Self::Direction | Self::Unipolar)
    }
}

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// Outputs on, from the next start of a period; off at once.
    pub enable: bool,
    /// 0 direction, 1 half bridge, 2 full bridge unipolar, 3 full bridge locked antiphase; 2 bits.
    pub mode: u8,
    /// Clocks per period; 0 stands for 65,536. Taken while off.
    pub period: u16,
    /// Clocks of the ideal high time, signed, 17 bits; beyond ±period is full.
    pub duty: i32,
    /// Largest |duty|.
    pub max_duty: u16,
    /// Duty and mode are taken at the peak too, not at the valley only.
    pub update_at_peak: bool,
    /// Clocks from one side's off to the other's on, 10 bits. Taken while off.
    pub dead_time: u16,
    /// Clocks of the shortest pulse, 10 bits. Taken while off.
    pub minimum_pulse: u16,
    /// One clock: the time base is here.
    pub sync: bool,
    /// Clocks after the valley at which the carrier is when `sync` comes.
    pub phase: u16,
    /// Clocks after the valley at which `trigger` comes.
    pub trigger_phase: u16,
    /// One clock: the controller lives.
    pub feed: bool,
    /// Valleys without `feed` that the watchdog lets pass; 0 is no watchdog.
    pub watchdog_periods: u8,
    /// Clocks that a filtered fault may last without effect.
    pub filter_clocks: u8,
    /// Raw fault, any time: low is a fault, or a broken wire.
    pub fault_n: bool,
    /// Any time: low trips as `fault_n` does.
    pub pll_locked: bool,
    /// Two faults behind synchroniser and filter, any time; low is a fault, or a broken wire.
    pub filtered_fault_n: u8,
    /// One clock: forget the causes that are over.
    pub clear_trip: bool,
    /// Clears `saturated`, `refused`, `below_floor`, `unaligned`.
    pub clear_flags: bool,
    /// Level: all pins off, from the next clock on; all else goes on as it would.
    pub mask_pins: bool,
}

/// Four gates, high side and low side of two legs: true is on (of the gate, not of the level).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Gates {
    /// High side of leg A; the PWM of mode `direction`.
    pub a_high: bool,
    /// Low side of leg A.
    pub a_low: bool,
    /// High side of leg B; the direction of mode `direction`.
    pub b_high: bool,
    /// Low side of leg B.
    pub b_low: bool,
}

impl Gates {
    /// Bit 0 `a_high`, 1 `a_low`, 2 `b_high`, 3 `b_low`.
    #[inline]
    fn to_bits(self) -> u64 {
        let gates = [self.a_high, self.a_low, self.b_high, self.b_low];
        (0..).zip(gates).map(|(at, gate)| u64::from(gate) << at).sum()
    }

    /// What a leg, and the rest of the bridge, are in a mode. `leg` is the leg that switches: its high side, its low side.
    /// `awake`: its first dead time is over.
    #[inline]
    pub(super) fn of(mode: Mode, negative: bool, awake: bool, leg: (bool, bool)) -> Self {
        let (high, low) = leg;
        let gates = |a_high, a_low, b_high, b_low| Self {
            a_high,
            a_low,
            b_high,
            b_low,
        };
        match (mode, negative) {
            (Mode::Direction, _) => gates(high, false, awake && negative, false),
            (Mode::HalfBridge, _) => gates(high, low, false, false),
            (Mode::Unipolar, false) => gates(high, low, false, awake),
            (Mode::Unipolar, true) => gates(false, awake, high, low),
            (Mode::Locked, _) => gates(high, low, low, high),
        }
    }
}

/// The output ports.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// The level of pin A high.
    pub a_high: bool,
    /// The level of pin A low.
    pub a_low: bool,
    /// The level of pin B high.
    pub b_high: bool,
    /// The level of pin B low.
    pub b_low: bool,
    /// The outputs are on.
    pub running: bool,
    /// A cause is standing: the outputs are off.
    pub tripped: bool,
    /// Bit 0: the fault latch; 1, 2: the filtered faults; 3: the PLL; 4: the watchdog.
    pub trip_causes: u8,
    /// The direction in use is negative.
    pub negative: bool,
    /// One clock: the pins are at the first clock of a period.
    pub valley: bool,
    /// One clock: the pins are in the middle of a period.
    pub peak: bool,
    /// One clock: the pins are `trigger_phase` clocks after the valley.
    pub trigger: bool,
    /// Sticky: a duty was limited by `max_duty`, by the period, or by the mode.
    pub saturated: bool,
    /// Sticky: another period, dead time or minimum pulse was wanted while running.
    pub refused: bool,
    /// Sticky: a dead time or minimum pulse below the floor was wanted while enabled; the floor is used.
    pub below_floor: bool,
    /// Sticky: `sync` came at another phase while running.
    pub unaligned: bool,
    /// Dead time in use, clocks.
    pub dead_time_used: u16,
    /// Minimum pulse in use, clocks.
    pub minimum_pulse_used: u16,
    /// The gates before fault path, mask and polarity.
    pub gates: Gates,
}

/// The ports of a PWM in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    use Direction::{Input, Output};
    let port = |name: &str, direction, width, signed| Port {
        name: name.to_owned(),
        direction,
        width,
        signed,
    };
    vec![
        port("rst", Input, 1, false),
        port("enable", Input, 1, false),
        port("mode", Input, 2, false),
        port("period", Input, 16, false),
        port("duty", Input, 17, true),
        port("max_duty", Input, 16, false),
        port("update_at_peak", Input, 1, false),
        port("dead_time", Input, TIME_BITS, false),
        port("minimum_pulse", Input, TIME_BITS, false),
        port("sync", Input, 1, false),
        port("phase", Input, 16, false),
        port("trigger_phase", Input, 16, false),
        port("feed", Input, 1, false),
        port("watchdog_periods", Input, 8, false),
        port("filter_clocks", Input, 8, false),
        port("fault_n", Input, 1, false),
        port("pll_locked", Input, 1, false),
        port("filtered_fault_n", Input, 2, false),
        port("clear_trip", Input, 1, false),
        port("clear_flags", Input, 1, false),
        port("mask_pins", Input, 1, false),
        port("a_high", Output, 1, false),
        port("a_low", Output, 1, false),
        port("b_high", Output, 1, false),
        port("b_low", Output, 1, false),
        port("running", Output, 1, false),
        port("tripped", Output, 1, false),
        port("trip_causes", Output, 5, false),
        port("negative", Output, 1, false),
        port("valley", Output, 1, false),
        port("peak", Output, 1, false),
        port("trigger", Output, 1, false),
        port("saturated", Output, 1, false),
        port("refused", Output, 1, false),
        port("below_floor", Output, 1, false),
        port("unaligned", Output, 1, false),
        port("dead_time_used", Output, TIME_BITS, false),
        port("minimum_pulse_used", Output, TIME_BITS, false),
        port("gates", Output, 4, false),
    ]
}

/// Input ports.
pub const INPUTS: usize = 21;
/// Output ports.
pub const OUTPUTS: usize = 18;
/// Bits of [`Inputs::duty`].
const DUTY_UNUSED_BITS: u32 = 32 - 17;

impl Inputs {
    /// From raw bit patterns, one per input port in port order.
    #[inline]
    pub fn from_raw(raw: &[u64; INPUTS]) -> Self {
        let bit = |at: usize| raw[at] & 1 != 0;
        Self {
            rst: bit(0),
            enable: bit(1),
            mode: raw[2] as u8 & 3,
            period: raw[3] as u16,
            duty: ((raw[4] as i32) << DUTY_UNUSED_BITS) >> DUTY_UNUSED_BITS,
            max_duty: raw[5] as u16,
            update_at_peak: bit(6),
            dead_time: raw[7] as u16,
            minimum_pulse: raw[8] as u16,
            sync: bit(9),
            phase: raw[10] as u16,
            trigger_phase: raw[11] as u16,
            feed: bit(12),
            watchdog_periods: raw[13] as u8,
            filter_clocks: raw[14] as u8,
            fault_n: bit(15),
            pll_locked: bit(16),
            filtered_fault_n: raw[17] as u8,
            clear_trip: bit(18),
            clear_flags: bit(19),
            mask_pins: bit(20),
        }
    }

    /// As raw bit patterns, one per input port in port order.
    pub fn to_raw(&self) -> [u64; INPUTS] {
        [
            u64::from(self.rst),
            u64::from(self.enable),
            u64::from(self.mode & 3),
            u64::from(self.period),
            self.duty as u64 & 0x1_ffff,
            u64::from(self.max_duty),
            u64::from(self.update_at_peak),
            u64::from(self.dead_time & 0x3ff),
            u64::from(self.minimum_pulse & 0x3ff),
            u64::from(self.sync),
            u64::from(self.phase),
            u64::from(self.trigger_phase),
            u64::from(self.feed),
            u64::from(self.watchdog_periods),
            u64::from(self.filter_clocks),
            u64::from(self.fault_n),
            u64::from(self.pll_locked),
            u64::from(self.filtered_fault_n & 3),
            u64::from(self.clear_trip),
            u64::from(self.clear_flags),
            u64::from(self.mask_pins),
        ]
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    #[inline]
    pub fn to_raw(&self) -> [u64; OUTPUTS] {
        [
            u64::from(self.a_high),
            u64::from(self.a_low),
            u64::from(self.b_high),
            u64::from(self.b_low),
            u64::from(self.running),
            u64::from(self.tripped),
            u64::from(self.trip_causes),
            u64::from(self.negative),
            u64::from(self.valley),
            u64::from(self.peak),
            u64::from(self.trigger),
            u64::from(self.saturated),
            u64::from(self.refused),
            u64::from(self.below_floor),
            u64::from(self.unaligned),
            u64::from(self.dead_time_used),
            u64::from(self.minimum_pulse_used),
            self.gates.to_bits(),
        ]
    }
}
