//! The register maps of the components, one file each.

mod pulse_counter;
mod pwm;
mod shaper;
mod sliding_mode;

pub use pulse_counter::pulse_counter;
pub use pwm::pwm;
pub use shaper::shaper;
pub(crate) use shaper::word_name;
pub use sliding_mode::sliding_mode;

use super::{Field, FlagSource};

/// The flag of every map that has commands.
pub(crate) fn partial_write(low: u32) -> Field {
    Field::flag("partial_write", low, "a write of only part of a word was ignored").set_by(FlagSource::PartialWrite)
}
