//! The ports of the PWM.

use crate::ports;
use crate::ports::PortValue;

/// Use of the four pins.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum BridgeMode {
    /// `a_high` is the PWM of |duty|, `b_high` its direction (on is negative); the other pins are off.
    #[default]
    Direction,
    /// Leg A switches with a duty from 0; leg B is off.
    HalfBridge,
    /// One leg switches with |duty|, the other stays on its low side: A for positive duty, B for negative.
    Unipolar,
    /// The high side of A and the low side of B switch together, in antiphase to the other two: duty 0 is 50 %.
    Locked,
}

impl BridgeMode {
    /// The mode for the register's value of 2 bits.
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

/// The four gates: high and low side of two legs. In a port bit 0 is `a_high`, 1 `a_low`, 2 `b_high`, 3 `b_low`. True
/// means that the gate is on, whatever its level.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Gates {
    /// High side of leg A; in mode `direction` the PWM.
    pub a_high: bool,
    /// Low side of leg A.
    pub a_low: bool,
    /// High side of leg B; in mode `direction` the direction.
    pub b_high: bool,
    /// Low side of leg B.
    pub b_low: bool,
}

impl Gates {
    /// The gates of the bridge in a mode. `leg` has the high and the low side of the leg that switches; `awake`: its first
    /// dead time is over.
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
        /// High: outputs on from the next start of a period. Low: off at once.
        enable: Bit as bool;
        /// 0 direction, 1 half bridge, 2 full bridge unipolar, 3 full bridge locked antiphase.
        mode: Bits(2) as u8;
        /// Clocks per period, from 64; 0 stands for 65,536. Taken while off.
        period: Bits(16) as u16, "clocks";
        /// Duty: the ideal high time; beyond ±`period` it is full.
        duty: Signed(17) as i32, "clocks";
        /// Largest |`duty`|; must not change in the 16 clocks before a boundary.
        max_duty: Bits(16) as u16, "clocks";
        /// Duty and mode are taken at the peak too.
        update_at_peak: Bit as bool;
        /// Dead time from one side's off to the other's on; not below its lower limit. Taken while off.
        dead_time: Bits(10) as u16, "clocks";
        /// Minimum pulse: the shortest on time of a side; not below its lower limit. Taken while off.
        minimum_pulse: Bits(10) as u16, "clocks";
        /// One clock: the synchronisation pulse of the time base.
        sync: Bit as bool;
        /// Phase of the carrier in the clock after `sync`, counted from the valley; below `period`.
        phase: Bits(16) as u16, "clocks";
        /// Phase at which `trigger` comes, counted from the valley.
        trigger_phase: Bits(16) as u16, "clocks";
        /// One clock: the controller is alive; it feeds the watchdog at every tick.
        feed: Bit as bool;
        /// Valleys without `feed` that are allowed; the next one trips. 0 disables the watchdog.
        watchdog_periods: Bits(8) as u8, "valleys";
        /// Longest filtered fault without effect.
        filter_clocks: Bits(8) as u8, "clocks";
        /// Raw fault, asynchronous; low, as with a broken wire, is a fault.
        fault_n: Bit as bool;
        /// Asynchronous; low trips as `fault_n` does.
        pll_locked: Bit as bool;
        /// Two faults with synchroniser and filter, asynchronous; low, as with a broken wire, is a fault.
        filtered_fault_n: Bits(2) as u8;
        /// One clock: clear the causes that are over.
        clear_trip: Bit as bool;
        /// Clears `saturated`, `refused`, `below_floor`, `unaligned`.
        clear_flags: Bit as bool;
        /// High: all pins are off one clock later; everything else continues.
        mask_pins: Bit as bool;
    }

    /// The output ports.
    outputs Outputs {
        /// Level of the pin for the high side of leg A.
        a_high: Bit as bool;
        /// Level of the pin for the low side of leg A.
        a_low: Bit as bool;
        /// Level of the pin for the high side of leg B.
        b_high: Bit as bool;
        /// Level of the pin for the low side of leg B.
        b_low: Bit as bool;
        /// The outputs are on.
        running: Bit as bool;
        /// The outputs are off because of a cause.
        tripped: Bit as bool;
        /// Causes of a trip: 0 fault latch, 1 and 2 filtered faults, 3 PLL, 4 watchdog.
        trip_causes: Bits(5) as u8;
        /// The direction in use is negative.
        negative: Bit as bool;
        /// One clock: the pins are at the first clock of a period.
        valley: Bit as bool;
        /// One clock: the pins are in the middle of a period.
        peak: Bit as bool;
        /// One clock: the pins are `trigger_phase` clocks after the valley.
        trigger: Bit as bool;
        /// Sticky: a duty was limited by `max_duty`, by the period, or by the half bridge at 0.
        saturated: Bit as bool;
        /// Sticky: another period, dead time or minimum pulse was requested while running.
        refused: Bit as bool;
        /// Sticky: while enabled, a time below its lower limit was requested, and the limit is used; or the period is
        /// 2 · (dead time + minimum pulse), and the PWM does not start.
        below_floor: Bit as bool;
        /// Sticky: a `sync` came at another phase while running.
        unaligned: Bit as bool;
        /// Dead time in use.
        dead_time_used: Bits(10) as u16, "clocks";
        /// Minimum pulse in use.
        minimum_pulse_used: Bits(10) as u16, "clocks";
        /// The gates before fault path, mask and polarity; 1 is on: 0 `a_high`, 1 `a_low`, 2 `b_high`, 3 `b_low`.
        gates: Bits(4) as Gates;
    }
}
