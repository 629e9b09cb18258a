//! What an axis takes from an absolute encoder: its count, with sign and zero, and its velocity.
//!
//! The reference is `posicast_blocks::absolute_feedback`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::absolute_feedback::{FEEDBACK_CLOCKS, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct AbsoluteFeedback;
    ports posicast_blocks::absolute_feedback_ports;

    registers {
        place: Bits<32>, last: Bits<32>, is_placed: Bit, steady: Bit, change: Bits<32>, is_new: Bit, pending: Bit, presets: Bit,
        smoothed: Signed<35> = from_i64(3), count_q: Bits<32>, placed_q: Bit, origin_q: Bits<32>, valid_q: Bit,
        missed_q: Bit,
    }
    wires {
        reading_bits: Bits<32>, moved: Bits<32>, range: Bits<32>, apart: Bits<32>, speed: Signed<32>,
        bounded: Signed<32>, target: Signed<36>, target_bits: Bits<36>, wide_smoothed: Signed<36>,
        difference: Signed<36>, wide_difference: Signed<37>, half: Signed<35>, coarse: Signed<37>, scaled: Bits<36>,
        resolved: Bits<36>, shrunk: Bits<35>, shown_position: Bits<32>,
    }
    constants {
        nothing: Bits<32> = from_u64(0),
        one_count: Bits<32> = from_u64(1),
        most: Signed<32> = from_i64(32_767),
        least: Signed<32> = from_i64(-32_767),
        rounding: Bits<36> = from_u64(3),
        one: Bits<36> = from_u64(1),
    }
}

impl Logic for AbsoluteFeedback {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module absolute_feedback");

        comment!("First clock of a reading: the place, and its change");
        self.reading_bits.next = unsigned_cast(self.reading.val());
        self.moved.next = self.nothing.val();
        if self.is_placed.q.val() {
            self.moved.next = self.reading_bits.val() - self.last.q.val();
        }
        self.range.next = self.sign_bit.val() | (self.sign_bit.val() - self.one_count.val());
        self.apart.next = (self.reading_bits.val() - self.offset.val()) & self.range.val();
        self.is_new.d.next = self.reading_valid.val();
        self.is_placed.d.next = self.reading_known.val() & (self.is_placed.q.val() | self.reading_valid.val());
        if self.reading_valid.val() {
            self.last.d.next = self.reading_bits.val();
            self.change.d.next = self.moved.val();
            self.place.d.next = (self.apart.val() ^ self.sign_bit.val()) - self.sign_bit.val();
            if self.is_placed.q.val() {
                self.place.d.next = self.place.q.val() + self.moved.val();
            }
        }

        comment!("Second clock: both with their sign");
        self.count_q.d.next = self.place.q.val();
        self.speed.next = signed_cast(self.change.q.val());
        if self.invert.val() {
            self.count_q.d.next = self.nothing.val() - self.place.q.val();
            self.speed.next = signed_cast(self.nothing.val() - self.change.q.val());
        }
        self.placed_q.d.next = self.is_placed.q.val();

        comment!("Controller and supervisor wait for a tick that begins");
        comment!("with the axis placed");
        self.steady.d.next = self.is_placed.q.val() & (self.steady.q.val() | self.tick.val());
        self.start.next = self.control.val() & self.steady.q.val();
        self.ready.next = self.drive_ready.val() & (self.steady.q.val() | self.lost.val());

        comment!("The change, bounded, is the velocity to be smoothed");
        self.bounded.next = self.speed.val();
        if self.speed.val() > self.most.val() {
            self.bounded.next = self.most.val();
        }
        if self.speed.val() < self.least.val() {
            self.bounded.next = self.least.val();
        }
        self.target.next = signed_bit_cast::<36, 32>(self.bounded.val());
        self.target_bits.next = (unsigned_cast(self.target.val()) << 19) | self.rounding.val();
        self.wide_smoothed.next = signed_bit_cast::<36, 35>(self.smoothed.q.val());
        self.difference.next = signed_cast(self.target_bits.val() - unsigned_cast(self.wide_smoothed.val()));

        comment!("Twice the distance, times 2^-k; then half of it,");
        comment!("rounded half up");
        self.half.next = self.difference.val().get_bits::<35>(1);
        self.wide_difference.next = signed_bit_cast::<37, 36>(self.difference.val());
        self.coarse.next = signed_cast(unsigned_cast(self.wide_difference.val()) << 1);
        if self.smoothing.val().get_bit(1) {
            self.coarse.next = signed_bit_cast::<37, 35>(self.half.val());
        }
        self.scaled.next = unsigned_cast(self.coarse.val().get_bits::<36>(0));
        if self.smoothing.val().get_bit(0) {
            self.scaled.next = unsigned_cast(self.coarse.val().get_bits::<36>(1));
        }
        self.resolved.next = ((unsigned_cast(self.wide_smoothed.val()) << 1) | self.one.val()) + self.scaled.val();
        self.shrunk.next = self.resolved.val().get_bits::<35>(1);
        self.valid_q.d.next = self.is_new.q.val();
        if self.is_new.q.val() {
            self.smoothed.d.next = signed_cast(self.shrunk.val());
            self.pending.d.next = false;
        }

        comment!("A tick whose velocity never came");
        if self.clear_flags.val() {
            self.missed_q.d.next = false;
        }
        if self.tick.val() {
            self.pending.d.next = true;
            if self.pending.q.val() & !self.is_new.q.val() & self.reading_known.val() {
                self.missed_q.d.next = true;
            }
        }

        comment!("The origin of the user's position");
        self.presets.d.next = self.preset.val();
        if self.presets.q.val() {
            self.origin_q.d.next = self.count_q.q.val() - unsigned_cast(self.preset_value.val());
        }
        self.shown_position.next = self.count_q.q.val() - self.origin_q.q.val();

        comment!("Outputs");
        self.count.next = signed_cast(self.count_q.q.val());
        self.placed.next = self.placed_q.q.val();
        self.origin.next = signed_cast(self.origin_q.q.val());
        self.position.next = signed_cast(self.shown_position.val());
        self.velocity.next = self.smoothed.q.val().get_bits::<32>(3);
        self.velocity_valid.next = self.valid_q.q.val();
        self.velocity_missed.next = self.missed_q.q.val();
    }
}

/// The block in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(AbsoluteFeedback::default());
    Ok(Box::new(Simulated::new("absolute_feedback", block, ports())?))
}

const NAME: &str = "absolute_feedback";

/// Name of the last module that [`emit()`] writes.
pub fn name(prefix: &str) -> String {
    emit::shared_name(prefix, NAME)
}

/// Verilog of the block; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: NAME.to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "What an axis takes from an absolute encoder: its count, with sign and zero, and its velocity."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "feedback_clocks".to_owned(),
                value: FEEDBACK_CLOCKS.to_string(),
                meaning: "from reading_valid to count and velocity".to_owned(),
            }],
        },
    };
    emit::emit(&AbsoluteFeedback::default(), &options)
}
