//! Inputs for shapers, one row of values per clock, without allocation in a clock.
//!
//! - [`Fill`] fills the delay line, one sample per pass, until every tap has been seen.
//! - [`Directed`] plays scripts: the directed cases ([`cases`]) and the corner cases of each size ([`corners`]).
//! - [`Random`] mixes everything at random from a seed, to find what nobody thought of.
//! - [`MotionStimuli`] strobes real command words at a steady rate.
//! - [`ShaperExercise`] lists the taps, banks and flags that a run has not exercised.
//! - [`Coverage`] counts what a run reached, so that a test can require it.
//!
//! All of them work on one shaper (`x`, `valid`, …) and on a machine's top module (`<axis>_x`, …; `rst` and `strobe`
//! shared): [`Layout`] finds the axes by their port names. Each other block has its own random stimuli and coverage,
//! under its own name.

mod axis;
mod axis_coverage;
mod cascade;
mod corners;
mod coverage;
mod directed;
mod divider;
mod drive_command;
mod encoder_generator;
mod error_table;
mod excitation;
mod exercise;
mod fill;
mod layout;
mod linear_scale;
mod link_host;
mod linked_stage;
mod motion;
mod part;
mod pulse_counter;
mod pwm;
mod random;
mod registers;
mod segments;
mod sliding_mode;
mod spi_bridge;
mod table;
mod trace;
mod uart_bridge;

pub use self::axis::AxisRandom;
pub use self::axis_coverage::{AxisCoverage, AxisSafety};
pub use self::cascade::{CascadeCoverage, CascadeRandom};
pub use self::corners::corners;
pub use self::coverage::Coverage;
pub use self::directed::{Action, Directed, cases, motion_cases};
pub use self::divider::{DividerCoverage, DividerRandom};
pub use self::drive_command::{DriveCommandCoverage, DriveCommandRandom};
pub use self::encoder_generator::{EncoderGeneratorCoverage, EncoderGeneratorRandom};
pub use self::error_table::{ErrorTableCoverage, ErrorTableRandom};
pub use self::excitation::{ExcitationCoverage, ExcitationRandom};
pub use self::exercise::ShaperExercise;
pub use self::fill::Fill;
pub use self::layout::{AxisLayout, Layout};
pub use self::linear_scale::{LinearScaleCoverage, LinearScaleRandom};
pub use self::linked_stage::LinkedStageRandom;
pub use self::motion::MotionStimuli;
pub use self::part::PartRandom;
pub use self::pulse_counter::{PulseCounterCoverage, PulseCounterRandom};
pub use self::pwm::{GateSafety, PwmCoverage, PwmRandom};
pub use self::random::Random;
pub use self::registers::{
    ComponentRandom, ReadPromises, RegistersCoverage, RegistersRandom, StageCoverage, StageRandom,
};
pub use self::segments::{SegmentsCoverage, SegmentsRandom};
pub use self::sliding_mode::{SlidingModeCoverage, SlidingModeRandom};
pub use self::spi_bridge::{SpiBridgeCoverage, SpiBridgeRandom};
pub use self::trace::{TraceCoverage, TraceRandom};
pub use self::uart_bridge::{UartBridgeCoverage, UartBridgeRandom};

/// Makes the inputs of the next clock.
pub trait Stimuli {
    /// Fills `inputs`, in the order of the input ports. `seen` holds the outputs of the previous clock (zeros in the
    /// first). Bits above a port's width are ignored.
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]);
}

/// Any function is a stimulus.
impl<F: FnMut(&[u64], &mut [u64])> Stimuli for F {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self(seen, inputs);
    }
}
