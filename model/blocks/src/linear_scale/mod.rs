//! Relates the counts of a motor's encoder to those of a linear scale.
//!
//! The datasheet is `docs/linear_scale.md`; the hardware is compared with this reference model.
//!
//! | `use_scale` | unit of position, velocity and deviation | deviation, since `align` | ratio |
//! |---|---|---|---|
//! | 1: the loop runs on the scale | scale counts | ratio · motor − scale | [`ScaleRatio::new`] |
//! | 0: the scale is only compared | motor counts | motor − ratio · scale | [`ScaleRatio::for_monitor`] |
//!
//! - Differences since `align` are modulo 2^32, and their products exact; each is rounded once, half up, and the
//!   deviation saturates at 32 bits. So nothing drifts, however far and often the axis moves.
//! - `velocity` is with `use_scale` ratio · `motor_velocity`, rounded and saturated; without, it is `motor_velocity`,
//!   a clock later.
//! - One multiplier, which takes a bit per clock, serves both: a product takes [`PASS_CLOCKS`] and is computed in the
//!   registers of the outputs. So read `deviation` from `deviation_valid` to the next tick, and `velocity` from the
//!   end of its computation to the next `velocity_valid`; in between they show intermediate bits.
//!
//! ```text
//! clock            0   1                 64  65              t   t+1             t+64 t+65
//! tick            ‾‾‾\_________________________________________________________________
//! deviation       --->< computed           >< d ---------------------------------------
//! deviation_valid ___________________________/‾‾‾\______________________________________
//! velocity_valid  ___________________________________________/‾‾‾\_____________________
//! velocity        ----------------------------------------------->< computed     >< v -
//! ```
//!
//! ```
//! use posicast_blocks::linear_scale::{Inputs, LATENCY_CLOCKS, LinearScale, ScaleRatio};
//!
//! // 2500 counts of the motor and 1000 of the scale per millimetre; the scale lags by 3 counts.
//! let ratio = ScaleRatio::new(2500.0, 1000.0)?;
//! let mut scale = LinearScale::new();
//! let tied = Inputs {
//!     ratio_mantissa: ratio.mantissa(),
//!     ratio_shift: ratio.shift() as u8,
//!     use_scale: true,
//!     ..Inputs::default()
//! };
//! scale.step(&Inputs { tick: true, motor_position: 250_000, scale_position: 99_997, ..tied });
//! let waited = (1..200).find(|_| scale.step(&tied).deviation_valid);
//! assert_eq!((waited, scale.outputs().deviation), (Some(LATENCY_CLOCKS), 3));
//! # Ok::<(), posicast_blocks::linear_scale::ScaleRatioError>(())
//! ```

mod ports;
mod ratio;

pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};
pub use ratio::{MANTISSA_BITS, RELATIVE_ERROR_MAX, SHIFT_BITS, ScaleRatio, ScaleRatioError};

use self::ratio::scaled;
use super::{Moore, clocked_block, quiet_at_rest, show_each};

/// Clocks of the multiplier for one product.
pub const PASS_CLOCKS: u32 = 64;
/// Clocks from `tick` to `deviation_valid`, and from `velocity_valid` to a new `velocity`, if the other is not being
/// computed.
pub const LATENCY_CLOCKS: u32 = PASS_CLOCKS + 1;

/// Both positions at a tick: the one that is multiplied, and the other one.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Pair {
    operand: i32,
    other: i32,
}

/// A product that is being computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pass {
    of_position: bool,
    /// Number of clocks done.
    done: u32,
    /// Number of clocks that shift the register: first the operand leaves, then the result enters.
    shifts: u32,
    /// Contents of the register at the start.
    operand: i32,
    /// The result before saturation.
    exact: i64,
}

/// All registers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Registers {
    /// Positions that wait for their product, or are in it.
    captured: Option<Pair>,
    /// A velocity that waits for its product, or is in it.
    velocity: Option<i32>,
    pass: Option<Pass>,
    /// Positions at which the deviation is 0.
    reference: Pair,
    /// Whether an `align` waits for the next product of the positions.
    asked: bool,
    /// Whether the present product of the positions takes them as the reference.
    aligning: bool,
    shown: Outputs,
}

/// The cycle-accurate model of the linear scale. The three constant inputs may change only in reset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinearScale {
    registers: Registers,
}

impl Default for LinearScale {
    fn default() -> Self {
        Self::new()
    }
}

impl LinearScale {
    /// The block after reset.
    pub fn new() -> Self {
        Self {
            registers: Registers::default(),
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        self.registers.shown
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.registers.shown;
        if inputs.rst {
            self.registers = Registers::default();
            return shown;
        }
        self.clock(inputs);
        shown
    }

    fn clock(&mut self, inputs: &Inputs) {
        let registers = &mut self.registers;
        let takes_positions = inputs.tick && registers.captured.is_none();
        let takes_velocity = inputs.velocity_valid && registers.velocity.is_none();
        let [operand, position] = if inputs.use_scale {
            [inputs.motor_position, inputs.scale_position]
        } else {
            [inputs.scale_position, inputs.motor_position]
        };
        registers.shown.position = position;
        registers.shown.deviation_valid = false;
        registers.asked |= inputs.align;
        if inputs.align && registers.captured.is_none() {
            registers.shown.deviation = 0;
        }
        registers.go_on();
        if takes_positions {
            let other = position;
            registers.captured = Some(Pair { operand, other });
            registers.shown.deviation = operand;
        }
        if takes_velocity {
            registers.velocity = inputs.use_scale.then_some(inputs.motor_velocity);
            registers.shown.velocity = inputs.motor_velocity;
        }
        if registers.pass.is_none() {
            registers.begin(inputs);
        }
    }
}

impl Registers {
    /// Simulates a clock of the present product, if there is one.
    fn go_on(&mut self) {
        let Some(pass) = &mut self.pass else {
            return;
        };
        pass.done += 1;
        let pass = *pass;
        if !pass.of_position {
            self.shown.velocity = pass.register();
            if pass.done == PASS_CLOCKS {
                self.shown.velocity = saturated(pass.exact);
                (self.pass, self.velocity) = (None, None);
            }
            return;
        }
        self.shown.deviation = pass.register();
        if pass.done < PASS_CLOCKS {
            return;
        }
        self.pass = None;
        self.shown.deviation_valid = true;
        self.shown.deviation = if self.aligning || self.asked {
            0
        } else {
            saturated(pass.exact)
        };
        let captured = self.captured.take();
        self.reference = captured.filter(|_| self.aligning).unwrap_or(self.reference);
    }

    /// Begins the next product, if one waits; positions come first.
    fn begin(&mut self, inputs: &Inputs) {
        let shift = u32::from(inputs.ratio_shift);
        let product = |operand| scaled(operand, inputs.ratio_mantissa, shift);
        let pass = |of_position, operand, exact| Pass {
            of_position,
            done: 0,
            shifts: i32::BITS + shift,
            operand,
            exact,
        };
        if let Some(Pair { operand, other }) = self.captured {
            self.aligning = std::mem::take(&mut self.asked);
            let product = product(operand.wrapping_sub(self.reference.operand));
            let other = i64::from(other.wrapping_sub(self.reference.other));
            let exact = if inputs.use_scale {
                product - other
            } else {
                other - product
            };
            self.pass = Some(pass(true, operand, exact));
        } else if let Some(velocity) = self.velocity {
            self.pass = Some(pass(false, velocity, product(velocity)));
        }
    }
}

impl Pass {
    /// Contents of the register while it shifts down: the operand leaves, zeros follow, then the result's bits.
    fn register(&self) -> i32 {
        let bits = i128::from(self.operand as u32) | i128::from(self.exact) << self.shifts;
        (bits >> self.done.min(self.shifts)) as i32
    }
}

fn saturated(exact: i64) -> i32 {
    exact.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

clocked_block!(LinearScale, "the linear scale");

impl Moore for LinearScale {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |next, raw| {
            LinearScale::step(next, &Inputs::from_raw(raw));
        })
    }
}
