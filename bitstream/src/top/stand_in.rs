//! A stand-in for the machine at a stage: a drive that follows its gates at once, and an encoder behind it. With it, a board without wires
//! shows moves.
//!
//! ```text
//! gates of the axis ─► command, −1, 0 or 1 ─► velocity (drive `Velocity`) ──────────────┬─► position ─► A, B
//!                                         └─► velocity + command (drive `Acceleration`) ┘
//! drive_enable and brake_release low: the axis stands
//! ```
//!
//! It has no modes, no friction and no limits, so it is no measure of a machine.

use std::fmt::Write;

/// Fraction bits of a position in counts, if the gates command a velocity.
const VELOCITY_FRACTION: u32 = 32;
/// Fraction bits of a position and a velocity, if they command an acceleration: 2^-52 counts per clock and clock are 0.6 counts/s² at 50 MHz.
const ACCELERATION_FRACTION: u32 = 52;
/// Bits of such a velocity: its largest value is an eighth of a count per clock.
const VELOCITY_BITS: u32 = ACCELERATION_FRACTION - 2;
/// Largest step of a position, in counts per clock: an encoder counter with a filter still sees every edge.
const LARGEST_STEP: f64 = 1.0 / 32.0;

/// What the levels of an axis's gates command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StandInGates {
    /// `a_high` is the PWM, `b_high` the direction: high is down.
    Direction,
    /// `a_high` alone: up or nothing.
    HalfBridge,
    /// Two legs: `a_high` and `b_low` are up, `b_high` and `a_low` down.
    Bridge,
}

/// What full duty means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StandInDrive {
    /// A velocity in counts per clock.
    Velocity(f64),
    /// An acceleration in counts per clock and clock.
    Acceleration(f64),
}

/// A stand-in for an axis: its drive, its brake and its encoder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StandIn {
    axis: String,
    gates: StandInGates,
    active_low: bool,
    reversed: bool,
    accelerates: bool,
    /// Step of position or velocity in a clock, with the fraction bits of the position.
    step: u64,
}

/// Full duty moves the stand-in too fast for an encoder, or not at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("full duty is {found:.3e} counts per clock; a stand-in needs more than 0 and at most 1/32")]
pub struct StandInStep {
    /// Counts per clock, or per clock and clock.
    pub found: f64,
}

impl StandIn {
    /// A stand-in for an axis. `active_low`: a gate is on at a low level. `reversed`: the lines count down where the position goes up.
    ///
    /// # Errors
    /// [`StandInStep`] for a drive that is too fast for an encoder, or too slow for the fraction bits.
    pub fn new(
        axis: &str,
        (gates, active_low): (StandInGates, bool),
        drive: StandInDrive,
        reversed: bool,
    ) -> Result<Self, StandInStep> {
        let (found, fraction, accelerates) = match drive {
            StandInDrive::Velocity(found) => (found, VELOCITY_FRACTION, false),
            StandInDrive::Acceleration(found) => (found, ACCELERATION_FRACTION, true),
        };
        let step = (found * (1u64 << fraction) as f64).round();
        if !(found <= LARGEST_STEP && step >= 1.0) {
            return Err(StandInStep { found });
        }
        Ok(Self {
            axis: axis.to_owned(),
            gates,
            active_low,
            reversed,
            accelerates,
            step: step as u64,
        })
    }

    /// Name of the axis.
    #[must_use]
    pub fn axis(&self) -> &str {
        &self.axis
    }

    /// Bits of the position: those of its fraction, and two of the count, which A and B show.
    fn place_bits(&self) -> u32 {
        let fraction = if self.accelerates {
            ACCELERATION_FRACTION
        } else {
            VELOCITY_FRACTION
        };
        fraction + 2
    }

    /// The stand-in in Verilog: nets `AXIS_a` and `AXIS_b` from the nets of the axis's gates, drive and brake.
    pub(super) fn verilog(&self) -> String {
        let Self { axis, step, .. } = self;
        let on = |gate: &str| format!("{}{axis}_{gate}", if self.active_low { "!" } else { "" });
        let [a_high, a_low, b_high, b_low] = ["a_high", "a_low", "b_high", "b_low"].map(on);
        let (up, down) = match self.gates {
            StandInGates::Direction => (
                format!("{a_high} & {}", negated(&b_high)),
                format!("{a_high} & {b_high}"),
            ),
            StandInGates::HalfBridge => (a_high, "1'b0".to_owned()),
            StandInGates::Bridge => (format!("{a_high} & {b_low}"), format!("{b_high} & {a_low}")),
        };
        let bits = self.place_bits();
        let mut text = format!(
            "
    // Axis {axis} without a machine: it follows its gates while the drive is enabled and the brake open.
    wire {axis}_moves = {axis}_drive_enable & {axis}_brake_release;
    wire {axis}_up    = {up};
    wire {axis}_down  = {down};
    reg  [{top}:0] {axis}_place = {bits}'d0; // counts, modulo 4
",
            top = bits - 1,
        );
        if self.accelerates {
            let _ = write!(
                text,
                "    reg  signed [{top}:0] {axis}_velocity = {VELOCITY_BITS}'sd0;

    always @(posedge clk) begin
        {axis}_place <= {axis}_place + {{{{{extension}{{{axis}_velocity[{top}]}}}}, {axis}_velocity}};
        if (!{axis}_moves) {axis}_velocity <= {VELOCITY_BITS}'sd0;
        else if ({axis}_up & !{axis}_down) {axis}_velocity <= {axis}_velocity + {VELOCITY_BITS}'sd{step};
        else if ({axis}_down & !{axis}_up) {axis}_velocity <= {axis}_velocity - {VELOCITY_BITS}'sd{step};
    end
",
                top = VELOCITY_BITS - 1,
                extension = bits - VELOCITY_BITS,
            );
        } else {
            let _ = write!(
                text,
                "
    always @(posedge clk) begin
        if ({axis}_moves & {axis}_up & !{axis}_down) {axis}_place <= {axis}_place + {bits}'d{step};
        else if ({axis}_moves & {axis}_down & !{axis}_up) {axis}_place <= {axis}_place - {bits}'d{step};
    end
"
            );
        }
        let [leads, follows] = if self.reversed { ["b", "a"] } else { ["a", "b"] };
        let _ = write!(
            text,
            "\n    assign {axis}_{leads} = {axis}_place[{high}] ^ {axis}_place[{low}];\n    assign {axis}_{follows} = {axis}_place[{high}];\n",
            high = bits - 1,
            low = bits - 2,
        );
        text
    }
}

/// The opposite of a gate's condition.
fn negated(condition: &str) -> String {
    match condition.strip_prefix('!') {
        Some(net) => net.to_owned(),
        None => format!("!{condition}"),
    }
}

/// Levels that a stand-in reads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StandInPins {
    /// `a_high`, `a_low`, `b_high`, `b_low`.
    pub gates: [bool; 4],
    /// Whether the drive is enabled.
    pub drive_enable: bool,
    /// Whether the brake is open.
    pub brake_release: bool,
}

/// The model of a stand-in, clock by clock.
#[derive(Debug, Clone)]
pub struct StandInModel {
    stand_in: StandIn,
    /// Position with its fraction bits; the count is not cut to two bits here.
    place: i128,
    velocity: i64,
}

impl StandInModel {
    /// The stand-in after configuration: at 0, at rest.
    #[must_use]
    pub fn new(stand_in: &StandIn) -> Self {
        Self {
            stand_in: stand_in.clone(),
            place: 0,
            velocity: 0,
        }
    }

    /// Counts from the start.
    #[must_use]
    pub fn count(&self) -> i64 {
        (self.place >> (self.stand_in.place_bits() - 2)) as i64
    }

    /// Lines A and B.
    #[must_use]
    pub fn lines(&self) -> [bool; 2] {
        let count = self.count();
        let lines = [(count + 1) & 2 != 0, count & 2 != 0];
        if self.stand_in.reversed {
            [lines[1], lines[0]]
        } else {
            lines
        }
    }

    /// A rising edge of the clock.
    pub fn clock(&mut self, pins: StandInPins) {
        let stand_in = &self.stand_in;
        let [a_high, a_low, b_high, b_low] = pins.gates.map(|level| level != stand_in.active_low);
        let command = match stand_in.gates {
            StandInGates::Direction if b_high => -i64::from(a_high),
            StandInGates::Direction | StandInGates::HalfBridge => i64::from(a_high),
            StandInGates::Bridge => i64::from(a_high && b_low) - i64::from(b_high && a_low),
        };
        let moves = pins.drive_enable && pins.brake_release;
        let change = if moves { command * stand_in.step as i64 } else { 0 };
        if !stand_in.accelerates {
            self.place += i128::from(change);
            return;
        }
        self.place += i128::from(self.velocity);
        let spare = i64::BITS - VELOCITY_BITS;
        self.velocity = if moves {
            (self.velocity + change) << spare >> spare
        } else {
            0
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: StandInPins = StandInPins {
        gates: [true, false, false, true],
        drive_enable: true,
        brake_release: true,
    };
    const DOWN: StandInPins = StandInPins {
        gates: [false, true, true, false],
        ..UP
    };

    fn bridge(drive: StandInDrive) -> StandInModel {
        StandInModel::new(&StandIn::new("x", (StandInGates::Bridge, false), drive, false).unwrap())
    }

    #[test]
    fn full_duty_is_the_velocity_of_the_drive_and_a_brake_holds() {
        let mut model = bridge(StandInDrive::Velocity(0.02));
        (0..10_000).for_each(|_| model.clock(UP));
        assert_eq!(model.count(), 200);
        model.clock(StandInPins {
            brake_release: false,
            ..UP
        });
        (0..10_000).for_each(|_| model.clock(DOWN));
        assert!((-1..=0).contains(&model.count()), "{}", model.count());
    }

    /// s = a t²/2.
    #[test]
    fn full_duty_is_the_acceleration_of_the_drive() {
        let mut model = bridge(StandInDrive::Acceleration(1e-6));
        (0..20_000).for_each(|_| model.clock(UP));
        assert!((model.count() - 200).abs() <= 1, "{}", model.count());
    }

    /// A leads B upwards: 00, 10, 11, 01.
    #[test]
    fn lines_change_one_at_a_time_and_a_leads() {
        let mut model = bridge(StandInDrive::Velocity(1.0 / 32.0));
        let mut shown = vec![model.lines()];
        for _ in 0..5 * 32 {
            model.clock(UP);
            if shown.last() != Some(&model.lines()) {
                shown.push(model.lines());
            }
        }
        let [low, high] = [false, true];
        assert_eq!(
            shown,
            [
                [low, low],
                [high, low],
                [high, high],
                [low, high],
                [low, low],
                [high, low]
            ]
        );
    }

    #[test]
    fn a_drive_that_is_too_fast_for_an_encoder_is_refused() {
        for drive in [
            StandInDrive::Velocity(0.04),
            StandInDrive::Velocity(0.0),
            StandInDrive::Acceleration(1e-17),
        ] {
            assert!(
                StandIn::new("x", (StandInGates::Bridge, false), drive, false).is_err(),
                "{drive:?}"
            );
        }
    }
}
