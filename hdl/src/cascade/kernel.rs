//! Computes a sample over all stages, two clocks each: one reads and writes the ring buffer, one adds.
//!
//! ```text
//! clock      0 (strobe)   2k + 1              2k + 2                 2n + 1         2n + 2
//! sum                     y_k                 y_k                    y_n
//! delays     of stage 0   of stage k          of stage k + 1
//! ring                    write y_k, read     y_k[n − d], add        y := rounded   valid
//! ```
//!
//! One RAM holds the ring buffers of all stages, which share `head` and `age`: a word's address is `{stage, head}`.
//! `age` counts the samples since the start, so no word is used that was not written since. Before the start, the
//! input of a stage was constant: `earlier`, the start value doubled from stage to stage.
//!
//! A delay is 1 to 2^A − 2, so the word read is never the one written in the same clock.

use crate::prelude::*;
use posicast_blocks::cascade::CascadeConfig;

kernel! {
    /// Sizes: W word bits, S sum bits (W + one per stage), A ring address bits, I stage index bits, ADDRESS = A + I.
    ///
    /// A cascade for `config`, whose sizes must not exceed these.
    pub(super) struct Cascade<const W: usize, const S: usize, const A: usize, const I: usize, const ADDRESS: usize>
        (config: &CascadeConfig)
        where S > W && ADDRESS == A + I;
    ports posicast_blocks::cascade_ports;

    parts {
        delays: Rom<A, I> = delays_rom(config),
        rings: Ram<S, ADDRESS>,
    }
    registers {
        head: Bits<A>, age: Bits<A>, start_value: Signed<W>, stage: Bits<I>, sum: Signed<S>,
        earlier: Signed<S>, before_start: Bit, running: Bit, adding: Bit, finish: Bit, y_q: Signed<W>,
        valid_q: Bit, busy_q: Bit, overrun_q: Bit,
    }
    wires {
        take: Bit, age_before: Bits<A>, next_head: Bits<A>, next_stage: Bits<I>, back: Bits<A>,
        base: Bits<ADDRESS>, delayed: Signed<S>, rounded: Signed<S>,
    }
    constants {
        one_sample: Bits<A> = from_u64(1),
        no_age: Bits<A> = from_u64(0),
        full_age: Bits<A> = from_u64((1 << config.ring_address_bits()) - 1),
        first_stage: Bits<I> = from_u64(0),
        one_stage: Bits<I> = from_u64(1),
        last_stage: Bits<I> = from_u64(u64::from(config.stages()) - 1),
        ring_bits: Bits<4> = from_u64(A as u64),
        half: Signed<S> = from_i64(1 << (u64::from(config.stages()) - 1)),
        stages: Bits<5> = from_u64(u64::from(config.stages())),
    }
}

fn delays_rom<const A: usize, const I: usize>(config: &CascadeConfig) -> Rom<A, I> {
    let word = |&delay: &u32| RomWord {
        pattern: u64::from(delay),
        meaning: format!("{delay} samples"),
    };
    Rom::new("stage_delays", config.delays_samples().iter().map(word).collect())
}

impl<const W: usize, const S: usize, const A: usize, const I: usize, const ADDRESS: usize> Logic
    for Cascade<W, S, A, I, ADDRESS>
{
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module cascade");
        self.next_stage.next = self.stage.q.val();
        self.valid_q.d.next = false;
        self.finish.d.next = false;
        if self.clear_flags.val() {
            self.overrun_q.d.next = false;
        }

        comment!("One clock to read and write, one to add");
        self.delayed.next = signed_cast(self.rings.read_data.val());
        if self.before_start.q.val() {
            self.delayed.next = self.earlier.q.val();
        }
        if self.running.q.val() {
            self.adding.d.next = !self.adding.q.val();
            if self.adding.q.val() {
                self.sum.d.next = self.sum.q.val() + self.delayed.val();
                self.earlier.d.next = self.earlier.q.val() + self.earlier.q.val();
                self.next_stage.next = self.stage.q.val() + self.one_stage.val();
                if self.stage.q.val() == self.last_stage.val() {
                    self.running.d.next = false;
                    self.finish.d.next = true;
                }
            }
        }

        comment!("Drop N bits, rounding halves up");
        self.rounded.next = self.sum.q.val() + self.half.val();
        if self.finish.q.val() {
            self.y_q.d.next = self.rounded.val().get_bits::<W>(self.stages.val().index());
            self.valid_q.d.next = true;
            self.busy_q.d.next = false;
        }

        comment!("A start clears, and abandons a running sample");
        self.age_before.next = self.age.q.val();
        if self.start.val() {
            self.start_value.d.next = self.x.val();
            self.y_q.d.next = self.x.val();
            self.age_before.next = self.no_age.val();
            self.age.d.next = self.no_age.val();
            self.running.d.next = false;
            self.finish.d.next = false;
            self.valid_q.d.next = false;
            self.busy_q.d.next = false;
        }

        comment!("Take a sample, unless one is being computed");
        self.take.next = self.strobe.val() & (self.start.val() | !self.busy_q.q.val());
        self.next_head.next = self.head.q.val() + self.one_sample.val();
        if self.take.val() {
            self.head.d.next = self.next_head.val();
            if self.age_before.val() != self.full_age.val() {
                self.age.d.next = self.age_before.val() + self.one_sample.val();
            }
            self.sum.d.next = signed_bit_cast::<S, W>(self.x.val());
            self.earlier.d.next = signed_bit_cast::<S, W>(self.start_value.q.val());
            if self.start.val() {
                self.earlier.d.next = signed_bit_cast::<S, W>(self.x.val());
            }
            self.next_stage.next = self.first_stage.val();
            self.running.d.next = true;
            self.adding.d.next = false;
            self.busy_q.d.next = true;
        }
        if self.strobe.val() & !self.take.val() {
            self.overrun_q.d.next = true;
        }

        comment!("Ring buffer of the stage, and its delay");
        self.stage.d.next = self.next_stage.val();
        self.delays.address.next = self.next_stage.val();
        self.back.next = self.head.q.val() - self.delays.data.val();
        self.base.next = bit_cast::<ADDRESS, I>(self.stage.q.val()) << self.ring_bits.val();
        self.rings.read_address.next = self.base.val() | bit_cast::<ADDRESS, A>(self.back.val());
        self.rings.write_address.next = self.base.val() | bit_cast::<ADDRESS, A>(self.head.q.val());
        self.rings.write_enable.next = self.running.q.val() & !self.adding.q.val();
        self.rings.write_data.next = unsigned_cast(self.sum.q.val());
        self.before_start.d.next = self.delays.data.val() >= self.age.q.val();

        comment!("Outputs");
        self.y.next = self.y_q.q.val();
        self.valid.next = self.valid_q.q.val();
        self.busy.next = self.busy_q.q.val();
        self.overrun.next = self.overrun_q.q.val();
    }
}
