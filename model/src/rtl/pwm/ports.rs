//! The ports of the PWM.

use crate::rtl::ports;
use crate::rtl::ports::PortValue;

/// What the four pins do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum BridgeMode {
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

impl BridgeMode {
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

/// Four gates, in a port bit 0 `a_high`, 1 `a_low`, 2 `b_high`, 3 `b_low`: high side and low side of two legs: true is on (of the gate, not of the level).
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
    /// What a leg, and the rest of the bridge, are in a mode. `leg` is the leg that switches: its high side, its low side.
    /// `awake`: its first dead time is over.
    #[inline]
    pub(super) fn of(mode: BridgeMode, negative: bool, awake: bool, leg: (bool, bool)) -> Self {
        let (high, low) = leg;
        let gates = |a_high, a_low, b_high, b_low| Self {
            a_high,
            a_low,
            b_high,
            b_low,
        };
        match (mode, negative) {
            (BridgeMode::Direction, _) => gates(high, false, awake && negative, false),
            (BridgeMode::HalfBridge, _) => gates(high, low, false, false),
            (BridgeMode::Unipolar, false) => gates(high, low, false, awake),
            (BridgeMode::Unipolar, true) => gates(false, awake, high, low),
            (BridgeMode::Locked, _) => gates(high, low, low, high),
        }
    }
}

impl PortValue for Gates {
    #[inline]
    fn from_pattern(pattern: u64, _: u32, _: bool) -> Self {
        let bit = |place: u32| pattern >> place & 1 != 0;
        Self {
            a_high: bit(0),
            a_low: bit(1),
            b_high: bit(2),
            b_low: bit(3),
        }
    }

    #[inline]
    fn pattern(self) -> u64 {
        let gates = [self.a_high, self.a_low, self.b_high, self.b_low];
        (0..).zip(gates).map(|(at, gate)| u64::from(gate) << at).sum()
    }
}

ports! {
    pwm_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// Outputs on, from the next start of a period; off at once.
        enable: Bit as bool;
        /// 0 direction, 1 half bridge, 2 full bridge unipolar, 3 full bridge locked antiphase.
        mode: Bits(2) as u8;
        /// Clocks per period, from 64; 0 is 65,536. Taken while off.
        period: Bits(16) as u16, "clocks";
        /// Clocks of the ideal high time; beyond ±`period` is full.
        duty: Signed(17) as i32, "clocks";
        /// Largest |`duty`|; still for the 16 clocks before a boundary.
        max_duty: Bits(16) as u16, "clocks";
        /// Duty and mode are taken at the peak too.
        update_at_peak: Bit as bool;
        /// Time from one side's off to the other's on; below the floor, the floor counts. Taken while off.
        dead_time: Bits(10) as u16, "clocks";
        /// Shortest pulse; below the floor, the floor counts. Taken while off.
        minimum_pulse: Bits(10) as u16, "clocks";
        /// One clock: the time base is here.
        sync: Bit as bool;
        /// Clocks after the valley at which the carrier is in the clock after `sync`; below `period`.
        phase: Bits(16) as u16, "clocks";
        /// Clocks after the valley at which `trigger` comes.
        trigger_phase: Bits(16) as u16, "clocks";
        /// One clock: the controller lives; every tick.
        feed: Bit as bool;
        /// Valleys without `feed` that pass; the next one trips. 0: no watchdog.
        watchdog_periods: Bits(8) as u8, "valleys";
        /// Clocks that a filtered fault may last without effect.
        filter_clocks: Bits(8) as u8, "clocks";
        /// Raw fault, any time: low is a fault, or a broken wire.
        fault_n: Bit as bool;
        /// Any time: low trips as `fault_n` does.
        pll_locked: Bit as bool;
        /// Two faults behind synchroniser and filter, any time; low is a fault, or a broken wire.
        filtered_fault_n: Bits(2) as u8;
        /// One clock: forget the causes that are over.
        clear_trip: Bit as bool;
        /// Clears `saturated`, `refused`, `below_floor`, `unaligned`.
        clear_flags: Bit as bool;
        /// High: all pins off, a clock later; all else goes on.
        mask_pins: Bit as bool;
    }

    /// The output ports.
    outputs Outputs {
        /// The level of pin A high.
        a_high: Bit as bool;
        /// The level of pin A low.
        a_low: Bit as bool;
        /// The level of pin B high.
        b_high: Bit as bool;
        /// The level of pin B low.
        b_low: Bit as bool;
        /// The outputs are on.
        running: Bit as bool;
        /// A cause stands; the outputs are off.
        tripped: Bit as bool;
        /// 0 fault latch, 1 and 2 filtered faults, 3 PLL, 4 watchdog.
        trip_causes: Bits(5) as u8;
        /// The direction in use.
        negative: Bit as bool;
        /// One clock: the pins are at the first clock of a period.
        valley: Bit as bool;
        /// One clock: the pins are in the middle of a period.
        peak: Bit as bool;
        /// One clock: the pins are `trigger_phase` clocks after the valley.
        trigger: Bit as bool;
        /// Sticky: a duty was limited, by `max_duty`, the period, or the half bridge at 0.
        saturated: Bit as bool;
        /// Sticky: another period, dead time or minimum pulse was wanted while running.
        refused: Bit as bool;
        /// Sticky: while enabled, a time below its floor was wanted, and the floor is used; or the period is 2 · (dead time
        /// + minimum pulse), and the PWM does not start.
        below_floor: Bit as bool;
        /// Sticky: `sync` came at another phase while running.
        unaligned: Bit as bool;
        /// Dead time in use.
        dead_time_used: Bits(10) as u16, "clocks";
        /// Minimum pulse in use.
        minimum_pulse_used: Bits(10) as u16, "clocks";
        /// The gates before fault path, mask and polarity, 1 is on: 0 `a_high`, 1 `a_low`, 2 `b_high`, 3 `b_low`.
        gates: Bits(4) as Gates;
    }
}
