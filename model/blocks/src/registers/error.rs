//! Errors of a description that prevent a register map.

/// Error of a description, with a remedy. The description is part of this project, so its user never causes one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MapError {
    /// A name has the wrong form, or the bank uses it itself.
    #[error(
        "`{0}` cannot be a name: [a-z][a-z0-9_]*; and as a port not `clk`, `rst`, `irq`, `mask`, `written`, `whole`, `waits`, `applies`, \
         `unused`, and not beginning with `avs_`, `bus_`, `write_`, `next_`, `allow_`, `shadow_`, `staged_`, `flag_`, \
         `irq_`"
    )]
    Name(String),
    /// There is no window, or there are too many.
    #[error("{0} windows: a map has 1 to {max}", max = super::MOST_WINDOWS)]
    Windows(u32),
    /// The first two registers are not those with which every map begins.
    #[error("a map begins with the constants `magic` at 0 and `version` at 1: make it by `Description::new`")]
    Beginning,
    /// Two registers have the same name.
    #[error("there are two registers `{0}`: rename one")]
    RegisterTwice(String),
    /// An offset is outside the window, or another register is there.
    #[error("the register `{register}` is at word {offset}: give it a free one of 0 to {last}")]
    Offset {
        /// Name of the register.
        register: String,
        /// Its offset in words.
        offset: u32,
        /// Last word of the windows.
        last: u32,
    },
    /// A field does not fit its register, or overlaps another.
    #[error("the field `{field}` of `{register}` has bits {low} to {high}: give it free ones of 0 to 31")]
    Bits {
        /// Name of the register.
        register: String,
        /// Name of the field.
        field: String,
        /// Its lowest bit.
        low: u32,
        /// Its highest bit.
        high: i64,
    },
    /// A number does not fit its field: reset value, minimum, choice, fraction bits, or the width of a flag.
    #[error("{what} of the field `{field}` of `{register}` is {found}, which its {width} bits do not allow")]
    Value {
        /// Name of the register.
        register: String,
        /// Name of the field.
        field: String,
        /// Kind of the number.
        what: &'static str,
        /// Its value.
        found: u32,
        /// Width of the field.
        width: u32,
    },
    /// Two ports have the same name. Fields and strobes that drive the hardware need distinct names; inputs that feed
    /// several registers must be alike.
    #[error(
        "the port `{port}` of the register `{register}` is taken, or not like the other input of that name: rename it"
    )]
    Port {
        /// Name of the register.
        register: String,
        /// Name of the port.
        port: String,
    },
    /// A shadow does not refer to a live register, or has fields of its own.
    #[error("`{shadow}` is to be the shadow of `{of}`: name a live register, and leave the shadow's fields to that")]
    Shadow {
        /// Name of the shadow.
        shadow: String,
        /// Name of the register to which it refers.
        of: String,
    },
    /// A register needs another register, or there are too many of a kind.
    #[error("{found} register(s) of access `{access}`: {rule}")]
    Missing {
        /// Kind of access.
        access: &'static str,
        /// Number of such registers.
        found: usize,
        /// Rule that is broken.
        rule: &'static str,
    },
    /// Fields do not suit the access of their register.
    #[error("the fields of `{register}` do not suit its access: {rule}")]
    Fields {
        /// Name of the register.
        register: String,
        /// Rule that is broken.
        rule: &'static str,
    },
}
