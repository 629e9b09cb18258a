//! Kernels that the emitter refuses: each is valid RustHDL, and each error names block, signal and remedy.

use crate::pitfalls::support::{Dff, Ram16x8, emit_as, emit_block, local, signed_bit_cast};
use posicast_hdl::emit::{EmitCause, EmitOptions, Type, emit};
use rust_hdl_core::prelude::*;

fn refused<K: Block + Default>(signal: &str, cause: EmitCause) {
    let error = emit_as::<K>("refused").unwrap_err();
    assert_eq!((error.signal.as_str(), &*error.cause), (signal, &cause), "{error}");
    assert_eq!(error.block, "dut");
}

/// Expects a kernel to be refused as unsupported, with a message that contains `words`.
fn unsupported<K: Block + Default>(words: &str) {
    let error = emit_as::<K>("refused").unwrap_err();
    assert!(
        matches!(&*error.cause, EmitCause::Unsupported { .. }) && error.to_string().contains(words),
        "{error}"
    );
}

const BITS_8: Type = Type {
    width: 8,
    signed: false,
};

// Order and completeness of assignments.
kernel!(LatchLocal { a: Bits<8>, s: Bit => y: Bits<8> } { t: Signal<Local, Bits<8>> = local() };
    #[hdl_gen] fn update(&mut self) { if self.s.val() { self.t.next = self.a.val(); } self.y.next = self.t.val(); });
kernel!(LatchOutput { a: Bits<8>, s: Bit => y: Bits<8> };
    #[hdl_gen] fn update(&mut self) { if self.s.val() { self.y.next = self.a.val(); } else { if self.a.val().any() { self.y.next = 0.into(); } } });
kernel!(ReadFirst { a: Bits<8> => y: Bits<8> } { t: Signal<Local, Bits<8>> = local() };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.t.val(); self.t.next = self.a.val(); });
kernel!(WriteAgain { a: Bits<8> => y: Bits<8> } { t: Signal<Local, Bits<8>> = local() };
    #[hdl_gen] fn update(&mut self) { self.t.next = self.a.val(); self.y.next = self.t.val(); self.t.next = self.a.val() + 1; });
kernel!(WriteAfterReadInBranch { a: Bits<8> => y: Bits<8> } { t: Signal<Local, Bits<8>> = local() };
#[hdl_gen] fn update(&mut self) {
    self.t.next = 0.into();
    self.y.next = 0.into();
    if self.a.val().any() { self.y.next = self.t.val(); }
    self.t.next = self.a.val();
});
kernel!(NoDriver { a: Bits<8> => y: Bits<8>, z: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val(); });
kernel!(NoReader { a: Bits<8> => y: Bits<8> } { t: Signal<Local, Bits<8>> = local() };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val(); self.t.next = self.a.val(); });
kernel!(DrivesInput { a: Bits<8> => y: Bits<8> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val(); self.a.next = 0.into(); });
kernel!(ConstantTest { a: Bits<8> => y: Bits<8> } { k: Constant<Bit> = Constant::new(true) };
    #[hdl_gen] fn update(&mut self) { self.y.next = 1.into(); if self.k.val() { self.y.next = 2.into(); } });

kernel!(WriteAfterReadInElse { a: Bits<8> => y: Bits<8> } { t: Signal<Local, Bits<8>> = local() };
#[hdl_gen] fn update(&mut self) {
    self.t.next = 0.into();
    if self.a.val().any() { self.y.next = 0.into(); } else { self.y.next = self.t.val(); }
    self.t.next = self.a.val();
});

#[test]
fn order_and_completeness() {
    refused::<LatchLocal>("t", EmitCause::Latch);
    refused::<LatchOutput>("y", EmitCause::Latch);
    refused::<ReadFirst>("t", EmitCause::ReadBeforeAssigned("t".into()));
    refused::<WriteAgain>("t", EmitCause::AssignedAfterRead);
    refused::<WriteAfterReadInBranch>("t", EmitCause::AssignedAfterRead);
    refused::<WriteAfterReadInElse>("t", EmitCause::AssignedAfterRead);
    refused::<NoDriver>("z", EmitCause::NeverAssigned);
    refused::<NoReader>("t", EmitCause::NeverRead);
    refused::<DrivesInput>("a", EmitCause::NotDrivable("an input"));
    refused::<ConstantTest>("y", EmitCause::ConstantCondition);
}

// Registers.
kernel!(NoClock { rst: Bit => y: Bits<8> } { r: Dff<Bits<8>> = Dff::new(0.into()) };
    #[hdl_gen] fn update(&mut self) { self.r.d.next = self.r.q.val(); self.r.rst.next = self.rst.val(); self.y.next = self.r.q.val(); });
kernel!(OtherReset { rst: Bit, clear: Bit => y: Bits<8> } { r: Dff<Bits<8>> = Dff::new(0.into()) } @ clk;
    #[hdl_gen] fn update(&mut self) { dff_setup!(self, clk, r); self.r.rst.next = self.rst.val() | self.clear.val(); self.y.next = self.r.q.val(); });
kernel!(NoReset { a: Bits<8> => y: Bits<8> } { r: Dff<Bits<8>> = Dff::new(0.into()) } @ clk;
    #[hdl_gen] fn update(&mut self) { self.r.clock.next = self.clk.val(); self.r.d.next = self.a.val(); self.y.next = self.r.q.val(); });
kernel!(ClockOfOtherName { a: Bits<8> => y: Bits<8> } @ clock;
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val(); });
kernel!(WritesQ { rst: Bit => y: Bits<8> } { r: Dff<Bits<8>> = Dff::new(0.into()) } @ clk;
    #[hdl_gen] fn update(&mut self) { dff_setup!(self, clk, r); self.r.q.next = 0.into(); self.y.next = self.r.q.val(); });

kernel!(GatedClock { rst: Bit, a: Bits<4> => y: Bits<8> } { ram: Ram16x8 = Ram16x8::default(), other: Signal<Local, Clock> = local() } @ clk;
#[hdl_gen] fn update(&mut self) {
    self.other.next = self.clk.val();
    self.ram.clk.next = self.other.val();
    self.ram.write_enable.next = self.rst.val();
    self.ram.write_address.next = self.a.val();
    self.ram.write_data.next = 0.into();
    self.ram.read_address.next = self.a.val();
    self.y.next = self.ram.read_data.val();
});

#[test]
fn registers() {
    refused::<GatedClock>("ram.clk", EmitCause::ClockWiring);
    refused::<NoClock>(
        "r",
        EmitCause::RegisterWiring {
            port: "clock",
            expected: "clk",
        },
    );
    refused::<OtherReset>(
        "r.rst",
        EmitCause::RegisterWiring {
            port: "rst",
            expected: "rst",
        },
    );
    refused::<NoReset>("r", EmitCause::MissingInput("rst"));
    refused::<ClockOfOtherName>("clock", EmitCause::ClockName);
    refused::<WritesQ>("r.q", EmitCause::NotDrivable("the output of a register"));
}

// Names.
kernel!(Keyword { initial: Bit => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.initial.val(); });
kernel!(SystemVerilogKeyword { logic: Bit => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.logic.val(); });
kernel!(Collision { rst: Bit => y: Bits<8> } { count: Dff<Bits<8>> = Dff::new(0.into()), count_next: Signal<Local, Bits<8>> = local() } @ clk;
    #[hdl_gen] fn update(&mut self) { dff_setup!(self, clk, count); self.count_next.next = 0.into(); self.y.next = self.count.q.val() + self.count_next.val(); });

#[test]
fn unit_names() {
    refused::<Keyword>("initial", EmitCause::ReservedWord("initial".into()));
    refused::<SystemVerilogKeyword>("logic", EmitCause::ReservedWord("logic".into()));
    let taken = EmitCause::NameCollision {
        name: "count_next".into(),
        other: "count_next".into(),
    };
    refused::<Collision>("count", taken);
    for (top, prefix, cause) in [
        ("module", "", EmitCause::ReservedWord("module".into())),
        ("", "", EmitCause::BadName(String::new())),
        ("dut", "XY stage", EmitCause::BadName("XY stage".into())),
    ] {
        let options = EmitOptions {
            top: top.into(),
            prefix: prefix.into(),
            ..EmitOptions::default()
        };
        assert_eq!(*emit(&NoDriver::default(), &options).unwrap_err().cause, cause);
    }
}

// Expressions and types.
kernel!(ConstGenericValue { a: Bits<16> => y: Bits<4> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val().get_bits::<4>(OFFSET); });
const OFFSET: usize = 5;
kernel!(SignalIndex { sel: Bits<2>, a: Bits<8> => y: Bits<8> } { v: [Constant<Bits<8>>; 4] = [0u64, 1, 2, 3].map(|v| Constant::new(v.into())) };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.v[self.sel.val().index()].val() ^ self.a.val(); });
kernel!(SliceOfSum { a: Bits<8>, b: Bits<8> => y: Bits<4> };
    #[hdl_gen] fn update(&mut self) { self.y.next = (self.a.val() + self.b.val()).get_bits::<4>(4); });
kernel!(SliceBeyond { a: Bits<8> => y: Bits<4> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val().get_bits::<4>(5); });
kernel!(SliceBySignal { a: Bits<8>, b: Bits<3> => y: Bits<4> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val().get_bits::<4>(self.b.val().index()); });
kernel!(ShiftBeyond { a: Bits<8> => y: Bits<8> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val() << 8; });
kernel!(IndexTooWide { a: Bits<8>, b: Bits<4> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val().get_bit(self.b.val().index()); });
kernel!(LiteralTooLarge { a: Bits<8> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val() == 256; });
kernel!(CastsOnBothSides { a: Signed<8>, b: Signed<8> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = signed_bit_cast::<4, 8>(self.a.val()) < signed_bit_cast::<4, 8>(self.b.val()); });
kernel!(SumWithBit { a: Bits<8>, b: Bit => y: Bits<8> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val() + self.b.val(); });
kernel!(Wide { a: Bits<65> => y: Bit };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val().any(); });
kernel!(LoopHidesSignal { i: Bits<8> => y: Bits<8> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.i.val(); for i in 0..2usize { if self.i.val() == i.to_bits() { self.y.next = 0.into(); } } });
kernel!(LongLoop { a: Bits<16> => y: Bits<16> };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val(); for i in 0..2000usize { if self.a.val() == i.to_bits() { self.y.next = 0.into(); } } });

kernel!(ProductUnderCast { a: Signed<16>, b: Signed<16> => y: Bits<32> };
    #[hdl_gen] fn update(&mut self) { self.y.next = unsigned_cast(self.a.val() * self.b.val()); });
kernel!(ConstantArithmeticIndex { a: Bits<16> => y: Bit } { k: Constant<Bits<4>> = Constant::new(15.into()) };
    #[hdl_gen] fn update(&mut self) { self.y.next = self.a.val().get_bits::<1>((self.k.val() + 1).index()).any(); });

#[test]
fn expressions() {
    refused::<ProductUnderCast>("y", EmitCause::NeedsLocal("a * b".into()));
    unsupported::<ConstantArithmeticIndex>("a slice at an offset that is a signal");
    let index = |text: &str| EmitCause::ArrayIndex(text.to_owned());
    refused::<ConstGenericValue>("y", EmitCause::UnknownSignal("OFFSET".into()));
    refused::<SignalIndex>("y", index("v[sel$val()$index()]"));
    refused::<SliceOfSum>("y", EmitCause::NeedsLocal("a + b".into()));
    refused::<SliceBeyond>(
        "y",
        EmitCause::OutOfRange {
            found: "a".into(),
            low: 5,
            high: 8,
            width: 8,
        },
    );
    unsupported::<SliceBySignal>("shift by the signal into a Local");
    refused::<ShiftBeyond>(
        "y",
        EmitCause::OutOfRange {
            found: "a".into(),
            low: 8,
            high: 8,
            width: 8,
        },
    );
    refused::<IndexTooWide>(
        "y",
        EmitCause::IndexRange {
            index_bits: 4,
            width: 8,
        },
    );
    refused::<LiteralTooLarge>(
        "y",
        EmitCause::Literal {
            value: 256,
            place: BITS_8,
        },
    );
    refused::<CastsOnBothSides>("y", EmitCause::WidthUnknown("`signed_bit_cast`"));
    let bit = Type {
        width: 1,
        signed: false,
    };
    refused::<SumWithBit>(
        "y",
        EmitCause::TypeMismatch {
            found: "b".into(),
            found_type: bit,
            expected: BITS_8,
        },
    );
    refused::<Wide>("a", EmitCause::Width(65));
    refused::<LoopHidesSignal>("i", EmitCause::LoopVariable("i".into()));
    refused::<LongLoop>("-", EmitCause::Loop { from: 0, to: 2000 });
}

// Leaves, and blocks that are invalid as leaves.
#[derive(LogicBlock, Default)]
struct Leaf<const TEXT: usize> {
    a: Signal<In, Bits<8>>,
    y: Signal<Out, Bits<8>>,
}

impl<const TEXT: usize> Logic for Leaf<TEXT> {
    fn update(&mut self) {}
    fn hdl(&self) -> Verilog {
        let text = [
            "assign y = a;",
            "// @leaf and\nassign y = a;",
            "// @leaf copy reg: z\nassign y = a;",
            "// @dff 8'h00",
            "// @leaf copy\nassign y = a;",
        ];
        Verilog::Custom(text[TEXT].to_owned())
    }
}

#[derive(LogicBlock, Default)]
struct BlackBoxed {
    a: Signal<In, Bits<8>>,
}

impl Logic for BlackBoxed {
    fn update(&mut self) {}
    fn hdl(&self) -> Verilog {
        Verilog::Wrapper(Wrapper {
            code: String::new(),
            cores: String::new(),
        })
    }
}

kernel!(WrongRegister { rst: Bit => y: Bits<8> } { r: Leaf<3> = Leaf::default() } @ clk;
    #[hdl_gen] fn update(&mut self) { self.r.a.next = 0.into(); self.y.next = self.r.y.val(); });

#[test]
fn unit_leaves() {
    let message = |text: Result<_, posicast_hdl::emit::EmitError>| text.map(|_: Vec<_>| ()).unwrap_err().to_string();
    assert!(message(emit_block(&Leaf::<0>::default(), "x")).contains("the first line is not"));
    assert!(message(emit_block(&Leaf::<1>::default(), "x")).contains("`and` is a reserved word"));
    assert!(message(emit_block(&Leaf::<2>::default(), "x")).contains("`z` after `reg:` is not an output"));
    assert!(emit_block(&Leaf::<4>::default(), "x").is_ok());
    assert!(message(emit_as::<WrongRegister>("x")).contains("a register has no Input port `clock`"));
    unsupported::<BlackBoxed>("write it as a leaf");
}

#[test]
fn message_names_block_signal_and_remedy() {
    assert_eq!(
        emit_as::<LatchLocal>("x").unwrap_err().to_string(),
        "block `dut`, signal `t`: it is not assigned on every path, which makes a latch; give it a default before the first `if`"
    );
}
