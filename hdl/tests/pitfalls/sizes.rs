//! Kernels at sizes that are not compiled: numbers that follow from the sizes are resolved, others are refused.

use crate::pitfalls::support::Dff;
use posicast_hdl::emit::{EmitCause, EmitError, EmitOptions, Module, emit, emit_sized};
use rust_hdl_core::prelude::*;
use rust_hdl_macros::{LogicBlock, hdl_gen};

fn options() -> EmitOptions {
    EmitOptions {
        top: "dut".to_owned(),
        ..EmitOptions::default()
    }
}

/// A register takes `4·a + b`, masked, unless `b` is 0, and `sum` shows it; `low` has the L bits of `4·a + b` from bit
/// 1 on.
///
/// SUM = A + B; any other width is an error that a test inserts.
#[derive(LogicBlock)]
struct Widths<const A: usize, const B: usize, const SUM: usize, const L: usize> {
    a: Signal<In, Bits<A>>,
    b: Signal<In, Bits<B>>,
    clk: Signal<In, Clock>,
    rst: Signal<In, Bit>,
    sum: Signal<Out, Bits<SUM>>,
    low: Signal<Out, Bits<L>>,
    held: Dff<Bits<SUM>>,
    total: Signal<Local, Bits<SUM>>,
    mask: Constant<Bits<SUM>>,
    shift: Constant<Bits<8>>,
}

/// Values of the constants and of the reset: from the configuration or, as an error that a test inserts, from the size.
struct Values {
    mask: u64,
    shift: u64,
    reset: u64,
}

const VALUES: Values = Values {
    mask: u64::MAX << 3,
    shift: 2,
    reset: 5,
};

impl<const A: usize, const B: usize, const SUM: usize, const L: usize> Widths<A, B, SUM, L> {
    fn new(values: &Values) -> Self {
        let bits = |value: u64| Bits::<SUM>::from(value & (u64::MAX >> (64 - SUM)));
        Self {
            a: Default::default(),
            b: Default::default(),
            clk: Default::default(),
            rst: Default::default(),
            sum: Default::default(),
            low: Default::default(),
            held: Dff::new(bits(values.reset)),
            total: Default::default(),
            mask: Constant::new(bits(values.mask)),
            shift: Constant::new(values.shift.into()),
        }
    }
}

impl<const A: usize, const B: usize, const SUM: usize, const L: usize> Logic for Widths<A, B, SUM, L> {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clk, held);
        self.total.next = (bit_cast::<SUM, A>(self.a.val()) << self.shift.val()) + bit_cast::<SUM, B>(self.b.val());
        if self.b.val().any() {
            self.held.d.next = self.total.val() & self.mask.val();
        }
        self.sum.next = self.held.q.val();
        self.low.next = self.total.val().get_bits::<L>(1);
    }
}

/// Emits at `wanted` from samples at the given sizes; `L` is a separate size, so that a test can make it wrong.
macro_rules! at {
    ($wanted:expr; $([$a:literal, $b:literal, $sum:literal, $l:literal] $values:expr),+) => {{
        let blocks: Vec<(&[u32], Box<dyn Block>)> =
            vec![$((&[$a, $b], Box::new(Widths::<$a, $b, $sum, $l>::new($values)) as Box<dyn Block>)),+];
        let samples: Vec<(&[u32], &dyn Block)> = blocks.iter().map(|(sizes, block)| (*sizes, block.as_ref())).collect();
        emit_sized(&samples, $wanted, &options())
    }};
}

/// Like `at!`, with all values taken from the configuration.
macro_rules! widths {
    ($wanted:expr; $([$($size:literal),+])+) => { at!($wanted; $([$($size),+] &VALUES),+) };
}

fn direct<const A: usize, const B: usize, const SUM: usize, const L: usize>() -> Result<Vec<Module>, EmitError> {
    emit(&Widths::<A, B, SUM, L>::new(&VALUES), &options())
}

/// Expects an error at this signal with this cause.
fn refused(result: Result<Vec<Module>, EmitError>, signal: &str, cause: EmitCause) {
    let error = result.unwrap_err();
    assert_eq!(
        (error.block.as_str(), error.signal.as_str()),
        ("dut", signal),
        "{error}"
    );
    assert_eq!(*error.cause, cause);
}

#[test]
fn a_size_that_is_not_compiled_comes_out_as_if_it_were() {
    let samples = |wanted: &[u32]| widths!(wanted; [12, 9, 21, 7] [11, 12, 23, 10] [10, 4, 14, 2]);
    assert_eq!(samples(&[12, 9]), direct::<12, 9, 21, 7>());
    assert_eq!(samples(&[10, 4]), direct::<10, 4, 14, 2>());
    assert_eq!(samples(&[6, 8]), direct::<6, 8, 14, 6>());
    assert_eq!(samples(&[9, 9]), direct::<9, 9, 18, 7>());
}

#[test]
fn a_width_that_is_no_sum_of_sizes_is_refused_at_its_signal() {
    // The width is A + B in two of three samples, and one more in the third.
    let result = widths!(&[9, 9]; [12, 9, 21, 7] [11, 12, 23, 10] [10, 4, 15, 2]);
    refused(result, "sum", EmitCause::SizeNumber("21, 23, 15".to_owned()));
    // The width is twice a size.
    let result = widths!(&[9, 9]; [12, 9, 24, 7] [11, 12, 22, 10] [10, 4, 20, 2]);
    refused(result, "sum", EmitCause::SizeNumber("24, 22, 20".to_owned()));
    // Both sizes change by the same amount, so the samples do not determine which one it is.
    let result = widths!(&[9, 9]; [12, 9, 21, 7] [11, 8, 19, 6]);
    refused(result, "a", EmitCause::SizeNumber("12, 11".to_owned()));
    // The width exceeds that of any signal.
    let result = widths!(&[60, 9]; [12, 9, 21, 7] [11, 12, 23, 10] [10, 4, 14, 2]);
    refused(result, "sum", EmitCause::Width(69));
}

#[test]
fn a_value_that_depends_on_the_size_is_refused() {
    let with = |mask, shift, reset| {
        let values = |of: usize| Values {
            mask: [VALUES.mask, VALUES.mask, mask][of],
            shift: [9, 12, shift][of],
            reset: [5, 5, reset][of],
        };
        at!(&[9, 9]; [12, 9, 21, 7] &values(0), [11, 12, 23, 10] &values(1), [10, 4, 14, 2] &values(2))
    };
    // A constant may be a size, or a sum of sizes.
    let text = with(VALUES.mask, 4, 5).unwrap().pop().unwrap().text;
    assert!(text.contains("<< 9"), "{text}");
    refused(
        with(VALUES.mask, 5, 5),
        "shift",
        EmitCause::SizeValue("9, 12, 5".to_owned()),
    );
    let values = (VALUES.mask & ((1 << 21) - 1), VALUES.mask & ((1 << 23) - 1));
    let found = format!("{}, {}, 16", values.0, values.1);
    refused(with(1 << 4, 4, 5), "mask", EmitCause::SizeValue(found));
    let error = with(VALUES.mask, 4, 6).unwrap_err();
    assert_eq!(
        (error.block.as_str(), &*error.cause),
        ("dut.held", &EmitCause::SizeValue("5, 5, 6".to_owned()))
    );
}

#[test]
fn a_value_that_the_wanted_width_does_not_hold_is_refused() {
    let values = Values {
        mask: 1 << 13,
        ..VALUES
    };
    let at = |wanted: &[u32]| at!(wanted; [12, 9, 21, 7] &values, [11, 12, 23, 10] &values, [10, 4, 14, 2] &values);
    assert!(at(&[6, 8]).is_ok());
    let place = posicast_hdl::emit::Type {
        width: 13,
        signed: false,
    };
    refused(at(&[6, 7]), "mask", EmitCause::Literal { value: 1 << 13, place });
}

/// A kernel with C inputs, whose form depends on C.
#[derive(LogicBlock)]
struct Inputs<const A: usize, const C: usize> {
    x: [Signal<In, Bits<A>>; C],
    y: [Signal<Out, Bits<A>>; C],
}

impl<const A: usize, const C: usize> Default for Inputs<A, C> {
    fn default() -> Self {
        Self {
            x: std::array::from_fn(|_| Signal::default()),
            y: std::array::from_fn(|_| Signal::default()),
        }
    }
}

impl<const A: usize, const C: usize> Logic for Inputs<A, C> {
    #[hdl_gen]
    fn update(&mut self) {
        for i in 0..C {
            self.y[i].next = self.x[i].val();
        }
    }
}

#[test]
fn forms_that_differ_are_refused() {
    let blocks: [(&[u32], &dyn Block); 2] = [(&[8], &Inputs::<8, 2>::default()), (&[9], &Inputs::<9, 3>::default())];
    let differs = |what: &str| EmitCause::SizesDiffer(what.to_owned());
    refused(emit_sized(&blocks, &[7], &options()), "-", differs("list of signals"));
    refused(
        emit_sized(&blocks, &[7, 8], &options()),
        "-",
        differs("number of sizes"),
    );
}
