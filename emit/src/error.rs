//! Errors of the emitter: the construct that it refuses, the place, and the remedy.
//!
//! An [`EmitError`] states *where* (block and signal), its [`EmitCause`] *what* was found and *what to do*. Every cause
//! is a design error of a kernel or of a call, never of a machine file: a correct kernel can be emitted for every
//! machine.

use super::types::Type;

/// The reason why no Verilog was written: `block`, `signal`, and the [`EmitCause`] with its remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("block `{block}`, signal `{signal}`: {cause}")]
pub struct EmitError {
    /// Path of the block from the top, joined by dots, or the name of the composed module.
    pub block: String,
    /// The signal whose declaration, assignment or read has the error; `-` where no signal is concerned.
    pub signal: String,
    /// What was found and what to do.
    pub cause: Box<EmitCause>,
}

impl EmitError {
    /// Creates the error of a block; an empty `signal` means none.
    pub fn new(block: &str, signal: &str, cause: EmitCause) -> Self {
        let signal = if signal.is_empty() { "-" } else { signal };
        Self {
            block: block.to_owned(),
            signal: signal.to_owned(),
            cause: Box::new(cause),
        }
    }
}

impl EmitCause {
    /// `value` as a bit pattern of the type; an error if it does not fit.
    pub(super) fn pattern(place: Type, value: i128) -> Result<u64, Self> {
        place.pattern(value).ok_or(Self::Literal { value, place })
    }
}

/// What was found, and the remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EmitCause {
    // Names.
    /// A name is not plain lower-case snake case.
    #[error("the name `{0}` is not of the form [a-z][a-z0-9_]*; rename it")]
    BadName(String),
    /// A name is a keyword of Verilog or SystemVerilog.
    #[error("`{0}` is a reserved word of Verilog or SystemVerilog; rename it")]
    ReservedWord(String),
    /// Two things have the same name.
    #[error("the Verilog name `{name}` is taken by `{other}`; rename one of them")]
    NameCollision {
        /// The name in the Verilog.
        name: String,
        /// The thing that already has the name.
        other: String,
    },

    /// Two different modules have the same name.
    #[error(
        "two modules are named `{0}` and differ; put the difference into the name, as in `@module history_${{width x}}`"
    )]
    OtherContent(String),

    // Declarations.
    /// The width is 0 or above 64.
    #[error("it is {0} bits wide, allowed are 1 to 64; split it")]
    Width(usize),
    /// A signal is of a struct type or bidirectional, or a RustHDL construct has no exact translation.
    #[error("{found} cannot be expressed exactly; {remedy}")]
    Unsupported {
        /// The construct.
        found: String,
        /// What to write instead.
        remedy: &'static str,
    },
    /// A clock input has another name than `clk`.
    #[error("a clock input must be called `clk`; rename it")]
    ClockName,
    /// A block with registers has no `clk` or `rst`.
    #[error("registers need an input `{0}` in the block that owns them; add it as a one-bit input")]
    MissingInput(&'static str),
    /// The tag or the form of a leaf is wrong.
    #[error("the leaf's tag is wrong: {0}; see the leaf convention in docs/emitter.md")]
    Leaf(String),

    // Names used in a kernel.
    /// A name is neither a signal nor a loop variable.
    #[error("`{0}` is not a signal of this block; a const generic used as a value goes into a `Constant`")]
    UnknownSignal(String),
    /// An array index is not a constant.
    #[error("array index in `{0}` is not a constant; compare with each index in a loop")]
    ArrayIndex(String),
    /// Loop bounds are not constant, or too far apart.
    #[error("loop from {from} to {to} is not unrolled; allowed are at most 1024 turns with constant bounds")]
    Loop {
        /// First index.
        from: i128,
        /// One past the last index.
        to: i128,
    },
    /// A loop variable hides a signal.
    #[error("the loop variable `{0}` hides a signal of that name; rename the loop variable")]
    LoopVariable(String),

    // Expressions.
    /// Operands, or the sides of an assignment, have different types.
    #[error("`{found}` is {found_type}, {expected} is needed; convert it through a Local of the right type")]
    TypeMismatch {
        /// The expression, as Verilog.
        found: String,
        /// Its type.
        found_type: Type,
        /// The type that the place needs.
        expected: Type,
    },
    /// A literal does not fit its type.
    #[error("the literal {value} does not fit {place}; use a smaller value or a wider signal")]
    Literal {
        /// The value.
        value: i128,
        /// The type it should have.
        place: Type,
    },
    /// The width of a literal or of a `signed_bit_cast` cannot be determined.
    #[error("the width of {0} cannot be told here; assign it to a Local, or use a `Constant`")]
    WidthUnknown(&'static str),
    /// A slice, cast or product is applied to an expression (kernel rule 3).
    #[error("`{0}` changes width inside a larger expression; assign it to a Local first and use that")]
    NeedsLocal(String),
    /// A slice exceeds its operand.
    #[error("bits {low} to {high} of `{found}` do not exist: it has {width}; correct the offset")]
    OutOfRange {
        /// The operand.
        found: String,
        /// First bit.
        low: i128,
        /// Last bit.
        high: i128,
        /// Width of the operand.
        width: u32,
    },
    /// The range of an index signal is not exactly that of the operand.
    #[error("an index of {index_bits} bits into {width} bits can point outside; use an index that fits exactly")]
    IndexRange {
        /// Width of the index.
        index_bits: u32,
        /// Width of the operand.
        width: u32,
    },

    // Assignments.
    /// The owner reads an input of a submodule or of a register (kernel rule 4, pitfall P11).
    #[error("`{0}` is the input of a submodule and is read here; simulation sees its final value, so read its source")]
    ReadsSubmoduleInput(String),
    /// The kernel drives a signal that has another driver.
    #[error("it is {0} and cannot be assigned here; assign a Local or an output")]
    NotDrivable(&'static str),
    /// Clock or reset of a register do not come from this block.
    #[error(
        "a register's `{port}` must be this block's `{expected}`; list the register in `dff_setup!(self, clk, ..)`"
    )]
    RegisterWiring {
        /// `clock` or `rst`.
        port: &'static str,
        /// The only allowed source.
        expected: &'static str,
    },
    /// The clock of a submodule does not come from this block: there is one clock (kernel rule 5).
    #[error("the clock of a submodule must be this block's `clk`; assign `self.clk.val()` to it")]
    ClockWiring,
    /// A signal is not assigned on every path, which makes a latch.
    #[error("it is not assigned on every path, which makes a latch; give it a default before the first `if`")]
    Latch,
    /// Nothing drives a signal.
    #[error("it is never assigned; assign it, or remove it")]
    NeverAssigned,
    /// Nothing reads a signal.
    #[error("it is never read; remove it")]
    NeverRead,
    /// A signal is read before it has a value.
    #[error("`{0}` is read before it is assigned; move the assignment up")]
    ReadBeforeAssigned(String),
    /// A signal is assigned after it was read: the simulation's reader sees the later value, Verilog's the earlier
    /// one.
    #[error("it is assigned again after it was read; assign it for the last time before anything reads it")]
    AssignedAfterRead,
    /// A match without `_` does not list all values.
    #[error("the match on `{0}` neither lists every value nor ends in `_`; add the missing arm")]
    MatchNotExhaustive(String),
    /// A condition depends on constants only.
    #[error("conditions on constants alone never trigger in an event simulator; decide them where the block is built")]
    ConstantCondition,

    // Sizes.
    /// A number is not a sum of sizes and a constant.
    #[error(
        "the number that is {0} at the sizes that are compiled is not a sum of sizes and a constant; \
         write it as one, or make it a size of its own"
    )]
    SizeNumber(String),
    /// A constant or reset value depends on the compiled size instead of the configuration.
    #[error("the value that is {0} at the sizes that are compiled depends on them; make it from the configuration")]
    SizeValue(String),
    /// Something differs between the compiled sizes.
    #[error("the {0} differs between the sizes that are compiled; keep a set of sizes for each form")]
    SizesDiffer(String),

    // Composition.
    /// No instance has a shared input.
    #[error("no instance has an input `{0}` to share; remove it from the shared inputs")]
    NoSuchInput(String),
    /// A shared input has two different types.
    #[error("the shared input `{name}` is {first} in one instance and {second} in `{instance}`; make them equal")]
    SharedType {
        /// Name of the input.
        name: String,
        /// Type in the instances before.
        first: Type,
        /// The instance that differs.
        instance: String,
        /// Its type there.
        second: Type,
    },
    /// A module differs from the composition's part in its ports, or is missing.
    #[error("the part `{0}` has other ports than the module that is to be it; make them from the same configuration")]
    PartPorts(String),
    /// An output has the name of a shared input.
    #[error("`{0}` is an output of an instance and cannot be shared; rename it or do not share it")]
    SharedOutput(String),
}
