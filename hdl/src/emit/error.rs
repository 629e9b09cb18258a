//! What the emitter refuses, where, and what to write instead.
//!
//! An [`EmitError`] says *where* (block and signal), its [`EmitCause`] says *what* was found and *what to do*. Every cause is a
//! design error of a kernel or of a call, never of a machine file: correct kernels emit for every machine.

use super::types::Type;

/// Why no Verilog was written: `block`, `signal`, and the [`EmitCause`] with its remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("block `{block}`, signal `{signal}`: {cause}")]
pub struct EmitError {
    /// Path of the block from the top, joined by dots, or the name of the module that was to be composed.
    pub block: String,
    /// The signal that is declared, assigned or read where the error was found; `-` where no signal is concerned.
    pub signal: String,
    /// What was found and what to do.
    pub cause: Box<EmitCause>,
}

impl EmitError {
    pub(crate) fn new(block: &str, signal: &str, cause: EmitCause) -> Self {
        let signal = if signal.is_empty() { "-" } else { signal };
        Self {
            block: block.to_owned(),
            signal: signal.to_owned(),
            cause: Box::new(cause),
        }
    }
}

impl EmitCause {
    /// `value` as a bit pattern of the type, or that it does not fit.
    pub(super) fn pattern(place: Type, value: i128) -> Result<u64, Self> {
        place.pattern(value).ok_or(Self::Literal { value, place })
    }
}

/// What was found, and the remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EmitCause {
    // Names.
    /// A name that is not plain lower-case snake case.
    #[error("the name `{0}` is not of the form [a-z][a-z0-9_]*; rename it")]
    BadName(String),
    /// A keyword of Verilog or SystemVerilog.
    #[error("`{0}` is a reserved word of Verilog or SystemVerilog; rename it")]
    ReservedWord(String),
    /// Two things with one name.
    #[error("the Verilog name `{name}` is taken by `{other}`; rename one of them")]
    NameCollision {
        /// The name in the Verilog.
        name: String,
        /// What has it already.
        other: String,
    },

    /// Two modules with one name that say different things.
    #[error("there are two modules `{0}` that differ; name what they differ in, as in `@module history_${{width x}}`")]
    OtherContent(String),

    // Declarations.
    /// Width 0 or above 64.
    #[error("it is {0} bits wide, allowed are 1 to 64; split it")]
    Width(usize),
    /// A struct-typed or bidirectional signal, or a RustHDL construct without exact translation.
    #[error("{found} cannot be expressed exactly; {remedy}")]
    Unsupported {
        /// The construct.
        found: String,
        /// What to write instead.
        remedy: &'static str,
    },
    /// A clock input under another name.
    #[error("a clock input must be called `clk`; rename it")]
    ClockName,
    /// A register in a block without `clk` or `rst`.
    #[error("registers need an input `{0}` in the block that owns them; add it as a one-bit input")]
    MissingInput(&'static str),
    /// Tag or shape of a leaf.
    #[error("the leaf's tag is wrong: {0}; see the leaf convention in docs/emitter.md")]
    Leaf(String),

    // Names used in a kernel.
    /// A name that is neither a signal nor a loop variable.
    #[error("`{0}` is not a signal of this block; a const generic used as a value goes into a `Constant`")]
    UnknownSignal(String),
    /// An array index that is not a constant.
    #[error("array index in `{0}` is not a constant; compare with each index in a loop")]
    ArrayIndex(String),
    /// Loop bounds.
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
    /// Operands or sides of an assignment of different type.
    #[error("`{found}` is {found_type}, {expected} is needed; convert it through a Local of the right type")]
    TypeMismatch {
        /// The expression, as Verilog.
        found: String,
        /// Its type.
        found_type: Type,
        /// The type that the place needs.
        expected: Type,
    },
    /// A literal that does not fit.
    #[error("the literal {value} does not fit {place}; use a smaller value or a wider signal")]
    Literal {
        /// The value.
        value: i128,
        /// The type it should have.
        place: Type,
    },
    /// A literal or `signed_bit_cast` where nothing says how wide it is.
    #[error("the width of {0} cannot be told here; assign it to a Local, or use a `Constant`")]
    WidthUnknown(&'static str),
    /// A slice, cast or product of an expression (kernel rule 3).
    #[error("`{0}` changes width inside a larger expression; assign it to a Local first and use that")]
    NeedsLocal(String),
    /// A slice beyond its operand.
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
    /// A signal as index whose range is not exactly the operand's.
    #[error("an index of {index_bits} bits into {width} bits can point outside; use an index that fits exactly")]
    IndexRange {
        /// Width of the index.
        index_bits: u32,
        /// Width of the operand.
        width: u32,
    },

    // Assignments.
    /// Input of a submodule, or of a register, read by its owner (kernel rule 4, pitfall P11).
    #[error("`{0}` is the input of a submodule and is read here; simulation sees its final value, so read its source")]
    ReadsSubmoduleInput(String),
    /// The kernel drives what others drive.
    #[error("it is {0} and cannot be assigned here; assign a Local or an output")]
    NotDrivable(&'static str),
    /// Clock or reset of a register from elsewhere.
    #[error(
        "a register's `{port}` must be this block's `{expected}`; list the register in `dff_setup!(self, clk, ..)`"
    )]
    RegisterWiring {
        /// `clock` or `rst`.
        port: &'static str,
        /// The only allowed source.
        expected: &'static str,
    },
    /// Clock of a submodule from elsewhere: there is one clock (kernel rule 5).
    #[error("the clock of a submodule must be this block's `clk`; assign `self.clk.val()` to it")]
    ClockWiring,
    /// Latch.
    #[error("it is not assigned on every path, which makes a latch; give it a default before the first `if`")]
    Latch,
    /// Nothing drives it.
    #[error("nothing assigns it; assign it, or remove it")]
    NeverAssigned,
    /// Nothing reads it.
    #[error("nothing reads it; remove it")]
    NeverRead,
    /// Read where it has no value yet.
    #[error("`{0}` is read before it is assigned; move the assignment up")]
    ReadBeforeAssigned(String),
    /// Assigned after a read: the simulation's reader sees the later value, Verilog's the earlier one.
    #[error("it is assigned again after it was read; assign it for the last time before anything reads it")]
    AssignedAfterRead,
    /// A match without `_` that leaves values out.
    #[error("the match on `{0}` neither lists every value nor ends in `_`; add the missing arm")]
    MatchNotExhaustive(String),
    /// Conditional logic that depends on constants only.
    #[error("conditions on constants alone never trigger in an event simulator; decide them where the block is built")]
    ConstantCondition,

    // Sizes.
    /// A number that is not a constant plus a sum of sizes.
    #[error(
        "the number that is {0} at the sizes that are compiled is no sum of sizes and a constant; \
         write it as one, or make it a size of its own"
    )]
    SizeNumber(String),
    /// A constant or reset value that depends on the size that is compiled instead of the configuration.
    #[error("the value that is {0} at the sizes that are compiled depends on them; make it from the configuration")]
    SizeValue(String),
    /// What is not the same at all sizes that are compiled.
    #[error("the {0} differs between the sizes that are compiled; keep a set of sizes for each form")]
    SizesDiffer(String),

    // Composition.
    /// A shared input that no instance has.
    #[error("no instance has an input `{0}` to share; remove it from the shared inputs")]
    NoSuchInput(String),
    /// A shared input of two different types.
    #[error("the shared input `{name}` is {first} in one instance and {second} in `{instance}`; make them equal")]
    SharedType {
        /// The input.
        name: String,
        /// Type in the instances before.
        first: Type,
        /// The instance that differs.
        instance: String,
        /// Its type there.
        second: Type,
    },
    /// A module that is not what the composition's part is: other ports, or one too few.
    #[error("the part `{0}` has other ports than the module that is to be it; make them from the same configuration")]
    PartPorts(String),
    /// An output that bears the name of a shared input.
    #[error("`{0}` is an output of an instance and cannot be shared; rename it or do not share it")]
    SharedOutput(String),
}
