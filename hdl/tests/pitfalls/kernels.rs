//! The pitfalls of RustHDL's own generator, one kernel each. Either the emitter's output behaves the same in RustHDL's
//! simulation, Icarus, Verilator and after Yosys, or the emitter refuses the kernel and accepts the form that it
//! suggests.
//!
//! P1 … P11 are the classes of docs/emitter.md.

use crate::pitfalls::support::{Dff, Kernel, Ram16x8, Row, emit_as, local, pairs, row, signed_bit_cast};
use crate::pitfalls::tools;
use posicast_hdl::emit::EmitCause;
use rust_hdl_core::prelude::*;

// P1, P2: constants and literals beside signed values.
kernel!(SignedConstant { a: Signed<16>, b: Signed<16> => y: Bit } { k: Constant<Signed<16>> = Constant::new(Signed::from(-5)) };
    #[hdl_gen] fn update(&mut self) { self.y.next = (self.a.val() < self.k.val()) ^ (self.b.val() > self.k.val()); });
kernel!(SignedLiteral { a: Signed<16>, b: Signed<16> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = (self.a.val() < 5.into()) ^ (self.b.val() < (-5).into()); });
kernel!(SignedConstantSum { a: Signed<16>, b: Signed<16> => y: Signed<16> } { k: Constant<Signed<16>> = Constant::new(Signed::from(-3)) };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val() + self.k.val() - self.b.val(); });

// P3, P4: signed products.
kernel!(ProductNested { a: Signed<16>, b: Signed<16> => y: Signed<48> };
    #[hdl_gen] fn update(&mut self) { self.y.next = signed_bit_cast::<48, 32>(self.a.val() * self.b.val()); });
kernel!(ProductLocal { a: Signed<16>, b: Signed<16> => y: Signed<48> } { p: Signal<Local, Signed<32>> = local() };
#[hdl_gen] fn update(&mut self) {
    self.p.next = self.a.val() * self.b.val();
    self.y.next = signed_bit_cast::<48, 32>(self.p.val());
});
kernel!(SumTimes { a: Signed<16>, b: Signed<16> => y: Signed<32> };
    #[hdl_gen] fn update(&mut self) { self.y.next = (self.a.val() + self.b.val()) * self.b.val(); });
kernel!(SumTimesLocal { a: Signed<16>, b: Signed<16> => y: Signed<32> } { s: Signal<Local, Signed<16>> = local() };
#[hdl_gen] fn update(&mut self) {
    self.s.next = self.a.val() + self.b.val();
    self.y.next = self.s.val() * self.b.val();
});
kernel!(UnsignedProduct { a: Bits<16>, b: Bits<16> => y: Bits<32> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val() * self.b.val(); });

// P5, P6: slices and truncations of signed values.
kernel!(SignedSlice { a: Signed<16>, b: Signed<8> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val().get_bits::<8>(8) < self.b.val(); });
kernel!(SignedSliceLocal { a: Signed<16>, b: Signed<8> => y: Bit } { t: Signal<Local, Signed<8>> = local() };
#[hdl_gen] fn update(&mut self) {
    self.t.next = self.a.val().get_bits::<8>(8);
    self.y.next = self.t.val() < self.b.val();
});
kernel!(SignedTruncation { a: Signed<16>, b: Signed<8> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = signed_bit_cast::<8, 16>(self.a.val()) < self.b.val(); });
kernel!(SignedExtension { a: Signed<16>, b: Signed<32> => y: Signed<32> };
    #[hdl_gen] fn update(&mut self) { self.y.next = signed_bit_cast::<32, 16>(self.a.val()) + self.b.val(); });
kernel!(ArithmeticShift { a: Signed<16>, b: Signed<16> => y: Signed<16> } { t: Signal<Local, Signed<12>> = local() };
#[hdl_gen] fn update(&mut self) {
    self.t.next = self.a.val().get_bits::<12>(4);
    self.y.next = signed_bit_cast::<16, 12>(self.t.val()) - self.b.val();
});
kernel!(NegationExtended { a: Signed<16>, b: Signed<16> => y: Signed<32> };
    #[hdl_gen] fn update(&mut self) { self.y.next = signed_bit_cast::<32, 16>(-self.a.val()); });
kernel!(NegationExtendedLocal { a: Signed<16>, b: Signed<16> => y: Signed<32> } { n: Signal<Local, Signed<16>> = local() };
#[hdl_gen] fn update(&mut self) {
    self.n.next = -self.a.val() - self.b.val();
    self.y.next = signed_bit_cast::<32, 16>(self.n.val());
});
kernel!(CastCompare { a: Bits<16>, b: Bits<16> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = signed_cast(self.a.val()) < signed_cast(self.b.val()); });
kernel!(CastSum { a: Bits<16>, b: Bits<16> => y: Signed<32> };
    #[hdl_gen] fn update(&mut self) { self.y.next = signed_bit_cast::<32, 16>(signed_cast(self.a.val() + self.b.val())); });
kernel!(CastSumLocal { a: Bits<16>, b: Bits<16> => y: Signed<32> } { s: Signal<Local, Bits<16>> = local() };
#[hdl_gen] fn update(&mut self) {
    self.s.next = self.a.val() + self.b.val();
    self.y.next = signed_bit_cast::<32, 16>(signed_cast(self.s.val()));
});

// P7: the carry that a cast must drop.
kernel!(CastCarry { a: Bits<8>, b: Bits<8> => y: Bits<16> };
    #[hdl_gen] fn update(&mut self) { self.y.next = bit_cast::<16, 8>(self.a.val() + self.b.val()); });
kernel!(CastBorrow { a: Bits<8>, b: Bits<8> => y: Bits<16> };
    #[hdl_gen] fn update(&mut self) { self.y.next = bit_cast::<16, 8>(self.a.val() - self.b.val()); });
kernel!(CastShift { a: Bits<8>, b: Bits<8> => y: Bits<16> };
    #[hdl_gen] fn update(&mut self) { self.y.next = bit_cast::<16, 8>(self.a.val() << 4); });
kernel!(CastLocal { a: Bits<8>, b: Bits<8> => y: Bits<16> } {
    sum: Signal<Local, Bits<8>> = local(), difference: Signal<Local, Bits<8>> = local(), shifted: Signal<Local, Bits<8>> = local()
};
#[hdl_gen] fn update(&mut self) {
    self.sum.next = self.a.val() + self.b.val();
    self.difference.next = self.a.val() - self.b.val();
    self.shifted.next = self.a.val() << 4;
    self.y.next = (bit_cast::<16, 8>(self.sum.val()) << 4) ^ (bit_cast::<16, 8>(self.difference.val()) << 8)
        ^ bit_cast::<16, 8>(self.shifted.val());
});
kernel!(ShiftCompare { a: Bits<8>, b: Bits<8> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = (self.a.val() << 4) == self.b.val(); });
kernel!(ShiftBySignal { a: Bits<8>, b: Bits<8> => left: Bits<8>, right: Bits<8> };
#[hdl_gen] fn update(&mut self) {
    self.left.next = self.a.val() << self.b.val();
    self.right.next = self.a.val() >> self.b.val().get_bits::<3>(0);
});

// P8, P9: literals in comparisons.
kernel!(LiteralWrap { a: Bits<8>, b: Bits<8> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val() + 1 == self.b.val(); });
kernel!(ConstantWrap { a: Bits<8>, b: Bits<8> => y: Bit } { k: Constant<Bits<8>> = Constant::new(1.into()) };
    #[hdl_gen] fn update(&mut self) { self.y.next = (self.a.val() + self.k.val()) == self.b.val(); });
kernel!(NotLiteral { a: Bits<8>, b: Bits<8> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = !self.a.val() == 0xF0; });

// P10: precedence.
kernel!(Precedence { a: Bits<8>, b: Bits<8> => y: Bit } { k: Constant<Bits<8>> = Constant::new(4.into()) };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val() & self.b.val() == self.k.val(); });

// These are correct as they are.
kernel!(Concatenation { a: Bits<8>, b: Bits<8> => y: Bits<16> };
    #[hdl_gen] fn update(&mut self) { self.y.next = (bit_cast::<16, 8>(self.a.val()) << 8) | bit_cast::<16, 8>(self.b.val()); });
kernel!(ReplaceBit { a: Bits<8>, b: Bits<8> => y: Bits<8>, top: Bits<8>, bottom: Bits<8> };
#[hdl_gen] fn update(&mut self) {
    self.y.next = self.a.val().replace_bit(3, self.b.val().get_bit(0));
    self.top.next = self.a.val().replace_bit(7, self.b.val().any());
    self.bottom.next = self.a.val().replace_bit(0, !self.b.val().get_bit(7));
});
kernel!(Reductions { a: Bits<8>, b: Bits<8> => y: Bit, parity: Bit };
#[hdl_gen] fn update(&mut self) {
    self.y.next = !self.a.val().any() & self.b.val().all();
    self.parity.next = (self.a.val() & self.b.val()).xor();
});
kernel!(Minimum { a: Signed<16>, b: Signed<16> => y: Signed<16> };
#[hdl_gen] fn update(&mut self) {
    self.y.next = self.a.val();
    if self.b.val() < self.a.val() { self.y.next = self.b.val(); }
});
kernel!(BitBySignal { a: Bits<8>, b: Bits<8> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val().get_bit(self.b.val().get_bits::<3>(0).index()); });
kernel!(LoopSelect { sel: Bits<8>, x: Bits<8> => y: Bits<8> } { bank: [Constant<Bits<8>>; 4] = [3, 5, 11, 200].map(|v: u64| Constant::new(v.into())) };
#[hdl_gen] fn update(&mut self) {
    self.y.next = self.x.val();
    for i in 0..4 {
        if self.sel.val() == i.to_bits() { self.y.next = self.bank[i].val() ^ self.x.val(); }
    }
});
kernel!(ConstantsOnly { a: Bits<8>, b: Bits<8> => y: Bits<8>, z: Signed<16> } { k: Constant<Signed<16>> = Constant::new(Signed::from(-32768)) };
    #[hdl_gen] fn update(&mut self) { self.y.next = 0xA5.into(); self.z.next = self.k.val(); });
kernel!(SmallestValue { a: Signed<16>, b: Signed<16> => y: Bit, z: Signed<32> } {
    k: Constant<Signed<16>> = Constant::new(signed_cast(Bits::from(0x8000))), low: Constant<Signed<32>> = Constant::new(signed_cast(Bits::from(0xffff_8000)))
};
#[hdl_gen] fn update(&mut self) {
    self.y.next = (self.a.val() == self.k.val()) | (self.b.val() == signed_bit_cast::<16, 32>(self.low.val()));
    self.z.next = signed_bit_cast::<32, 16>(self.k.val()) - signed_bit_cast::<32, 16>(self.b.val());
});

kernel!(LongWords { a: Bits<64>, b: Signed<64> => shifted: Bits<64>, less: Bit, sum: Signed<64>, high: Signed<40>, wide: Signed<64> } {
    top: Signal<Local, Signed<40>> = local(), k: Constant<Signed<64>> = Constant::new(signed_cast(Bits::from(0x8000_0000_0000_0001)))
};
#[hdl_gen] fn update(&mut self) {
    self.shifted.next = (self.a.val() << self.a.val().get_bits::<7>(3)) ^ (self.a.val() >> 33);
    self.less.next = (self.b.val() < signed_cast(self.a.val())) ^ (self.b.val() >= self.k.val());
    self.sum.next = self.b.val() + self.k.val() - (-1).into();
    self.top.next = self.b.val().get_bits::<40>(24);
    self.high.next = -self.top.val();
    self.wide.next = signed_bit_cast::<64, 40>(self.top.val());
});

// P11 and state.
#[derive(Copy, Clone, PartialEq, Debug, LogicState)]
enum Phase {
    Idle,
    RunUp,
    Hold,
}

kernel!(ReadsNext { rst: Bit, hit: Bit => y: Bits<8> } { count: Dff<Bits<8>> = Dff::new(0.into()) } @ clk;
#[hdl_gen] fn update(&mut self) {
    dff_setup!(self, clk, count);
    self.y.next = self.count.d.val();
    if self.hit.val() { self.count.d.next = self.count.q.val() + 1; }
});
kernel!(ReadsNextLocal { rst: Bit, hit: Bit => y: Bits<8> } {
    count: Dff<Bits<8>> = Dff::new(250.into()), next: Signal<Local, Bits<8>> = local()
} @ clk;
#[hdl_gen] fn update(&mut self) {
    dff_setup!(self, clk, count);
    self.next.next = self.count.q.val();
    if self.hit.val() { self.next.next = self.count.q.val() + 1; }
    self.count.d.next = self.next.val();
    self.y.next = self.next.val();
});
kernel!(OwnStateOnly { rst: Bit, x: Bit => y: Bits<4> } { count: Dff<Bits<4>> = Dff::new(9.into()) } @ clk;
#[hdl_gen] fn update(&mut self) {
    dff_setup!(self, clk, count);
    self.count.d.next = self.count.q.val() + 1;
    if self.count.q.val() == 12 { self.count.d.next = 3.into(); }
    self.y.next = self.count.q.val();
});
kernel!(States { rst: Bit, go: Bit => y: Bits<2>, busy: Bit, low: Signed<8> } {
    phase: Dff<Phase> = Dff::new(Phase::Hold), level: Dff<Signed<8>> = Dff::new(Signed::from(-7))
} @ clk;
#[hdl_gen] fn update(&mut self) {
    dff_setup!(self, clk, phase, level);

    comment!("phases in turn");
    self.y.next = 0.into();
    match self.phase.q.val() {
        Phase::Idle => { if self.go.val() { self.phase.d.next = Phase::RunUp; } }
        Phase::RunUp => { self.y.next = 1.into(); self.phase.d.next = Phase::Hold; self.level.d.next = self.level.q.val() - (-3).into(); }
        Phase::Hold => { self.y.next = 2.into(); if !self.go.val() { self.phase.d.next = Phase::Idle; } }
    }
    comment!("outputs");
    self.busy.next = self.phase.q.val() != Phase::Idle;
    self.low.next = self.level.q.val();
});
kernel!(Memory { rst: Bit, x: Bits<8> => y: Bits<8>, w: Bits<4> } {
    ram: Ram16x8 = Ram16x8::default(), at: Dff<Bits<4>> = Dff::new(0.into()), past: [Dff<Bits<8>>; 2] = [Dff::new(1.into()), Dff::new(2.into())]
} @ clk;
#[hdl_gen] fn update(&mut self) {
    dff_setup!(self, clk, at);
    for i in 0..2 {
        self.past[i].clock.next = self.clk.val();
        self.past[i].rst.next = self.rst.val();
    }
    self.past[0].d.next = self.x.val();
    for i in 0..1 { self.past[i + 1].d.next = self.past[i].q.val(); }
    self.at.d.next = self.at.q.val() + 1;
    self.ram.clk.next = self.clk.val();
    self.ram.write_enable.next = true;
    self.ram.write_address.next = self.at.q.val();
    self.ram.write_data.next = self.x.val();
    self.ram.read_address.next = self.at.q.val() - 3;
    self.y.next = self.ram.read_data.val() ^ self.past[1].q.val();
    self.w.next = self.x.val().get_bits::<4>(4);
});

fn simulated() -> Vec<Row> {
    fn of<K: Kernel>(name: &str, a: u32, b: u32) -> Row {
        row::<K>(name, pairs(a, b))
    }
    let mut random = 1u64;
    // Resets are random, but the first clock has none, so that the power-up value is tested.
    let mut clocked = move |mask: u64| -> Vec<Vec<u64>> {
        let mut next = || {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            random >> 40
        };
        (0..300)
            .map(|n| vec![u64::from(n > 0 && next() % 23 == 0), next() & mask])
            .collect()
    };
    vec![
        of::<SignedConstant>("signed_constant", 16, 16),
        of::<SignedLiteral>("signed_literal", 16, 16),
        of::<SignedConstantSum>("signed_constant_sum", 16, 16),
        of::<ProductLocal>("product_local", 16, 16),
        of::<SumTimesLocal>("sum_times_local", 16, 16),
        of::<UnsignedProduct>("unsigned_product", 16, 16),
        of::<SignedSlice>("signed_slice", 16, 8),
        of::<SignedSliceLocal>("signed_slice_local", 16, 8),
        of::<SignedTruncation>("signed_truncation", 16, 8),
        of::<SignedExtension>("signed_extension", 16, 32),
        of::<ArithmeticShift>("arithmetic_shift", 16, 16),
        of::<NegationExtendedLocal>("negation_extended_local", 16, 16),
        of::<CastCompare>("cast_compare", 16, 16),
        of::<CastSumLocal>("cast_sum_local", 16, 16),
        of::<CastLocal>("cast_local", 8, 8),
        of::<ShiftCompare>("shift_compare", 8, 8),
        of::<ShiftBySignal>("shift_by_signal", 8, 8),
        of::<LiteralWrap>("literal_wrap", 8, 8),
        of::<ConstantWrap>("constant_wrap", 8, 8),
        of::<NotLiteral>("not_literal", 8, 8),
        of::<Precedence>("precedence", 8, 8),
        of::<Concatenation>("concatenation", 8, 8),
        of::<ReplaceBit>("replace_bit", 8, 8),
        of::<Reductions>("reductions", 8, 8),
        of::<Minimum>("minimum", 16, 16),
        of::<BitBySignal>("bit_by_signal", 8, 8),
        of::<LoopSelect>("loop_select", 8, 8),
        of::<ConstantsOnly>("constants_only", 8, 8),
        of::<SmallestValue>("smallest_value", 16, 16),
        of::<LongWords>("long_words", 64, 64),
        row::<ReadsNextLocal>("reads_next_local", clocked(1)),
        row::<OwnStateOnly>("own_state_only", clocked(1)),
        row::<States>("states", clocked(1)),
        row::<Memory>("memory", clocked(255)),
    ]
}

#[test]
fn crosssim_every_kernel_means_the_same_in_every_tool() {
    let rows = simulated();
    let vectors: usize = rows.iter().map(|row| row.vectors.len()).sum();
    assert!(vectors > 8000, "{vectors} vectors");
    assert_eq!(tools::replay(&rows), Vec::<String>::new());
}

/// The bench itself must detect a difference: one bit of one expectation is inverted.
#[test]
fn long_crosssim_bench_notices_one_wrong_bit() {
    let mut wrong = row::<SignedConstant>("wrong", pairs(16, 16));
    wrong.vectors[17][2] ^= 1;
    let differences = tools::replay(&[wrong]);
    assert_eq!(differences.len(), 3, "{differences:?}");
    assert!(
        differences.iter().all(|line| line.contains("vector 17")),
        "{differences:?}"
    );
}

/// The rows that change width inside an expression are refused; their `…_local` forms are in the table above.
#[test]
fn width_changes_inside_expressions_are_refused() {
    fn check<K: Kernel>(text: &str) {
        let error = emit_as::<K>("dut").unwrap_err();
        assert_eq!(*error.cause, EmitCause::NeedsLocal(text.to_owned()), "{error}");
        assert_eq!(error.signal, "y");
    }
    check::<ProductNested>("a * b");
    check::<SumTimes>("a + b");
    check::<NegationExtended>("-a");
    check::<CastSum>("$signed(a + b)");
    check::<CastCarry>("a + b");
    check::<CastBorrow>("a - b");
    check::<CastShift>("a << 4");
}

/// P11: the simulation sees the final value of a register's input, Verilog the value so far.
#[test]
fn reading_a_register_input_is_refused() {
    let error = emit_as::<ReadsNext>("dut").unwrap_err();
    assert_eq!(*error.cause, EmitCause::ReadsSubmoduleInput("count.d".to_owned()));
}
