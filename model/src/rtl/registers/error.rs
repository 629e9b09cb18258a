//! Why a description makes no register map.

/// What was found, and what to do. Every one is an error of a description in this project, never of its user.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MapError {
    /// A name of the wrong form, or one that the bank needs.
    #[error(
        "`{0}` cannot be a name: [a-z][a-z0-9_]*; and as a port not `clk`, `rst`, `irq`, `mask`, `written`, `whole`, `waits`, `applies`, \
         `unused`, and not beginning with `avs_`, `bus_`, `write_`, `next_`, `allow_`, `shadow_`, `staged_`, `flag_`, \
         `irq_`"
    )]
    Name(String),
    /// No window, or too many.
    #[error("{0} windows: a map has 1 to {max}", max = super::MOST_WINDOWS)]
    Windows(u32),
    /// The first two registers are not what every map begins with.
    #[error("a map begins with the constants `magic` at 0 and `version` at 1: make it by `Description::new`")]
    Beginning,
    /// Two registers of one name.
    #[error("there are two registers `{0}`: rename one")]
    RegisterTwice(String),
    /// An offset outside of the window, or a second register there.
    #[error("the register `{register}` is at word {offset}: give it a free one of 0 to {last}")]
    Offset {
        /// The register.
        register: String,
        /// Its offset.
        offset: u32,
        /// The last word of the windows.
        last: u32,
    },
    /// A field that does not fit its register, or overlaps another.
    #[error("the field `{field}` of `{register}` has bits {low} to {high}: give it free ones of 0 to 31")]
    Bits {
        /// The register.
        register: String,
        /// The field.
        field: String,
        /// Its lowest bit.
        low: u32,
        /// Its highest bit.
        high: i64,
    },
    /// A number that does not fit a field: reset value, minimum, choice, fraction bits; or a flag of several bits.
    #[error("{what} of the field `{field}` of `{register}` is {found}, which its {width} bits do not allow")]
    Value {
        /// The register.
        register: String,
        /// The field.
        field: String,
        /// What it is.
        what: &'static str,
        /// Its value.
        found: u32,
        /// Width of the field.
        width: u32,
    },
    /// Two ports of one name: fields and strobes that drive the hardware need names of their own, inputs that feed
    /// several registers must be alike.
    #[error(
        "the port `{port}` of the register `{register}` is taken, or not like the other input of that name: rename it"
    )]
    Port {
        /// The register.
        register: String,
        /// The port.
        port: String,
    },
    /// A shadow of something that is not a live register, or with fields of its own.
    #[error("`{shadow}` is to be the shadow of `{of}`: name a live register, and leave the shadow's fields to that")]
    Shadow {
        /// The shadow.
        shadow: String,
        /// What it freezes.
        of: String,
    },
    /// Registers that need another register, or more than one of a kind of which there can be one.
    #[error("{found} register(s) of access `{access}`: {rule}")]
    Missing {
        /// The kind of access.
        access: &'static str,
        /// How many there are.
        found: usize,
        /// What must hold.
        rule: &'static str,
    },
    /// Flags of several bits, or fields where an access has none.
    #[error("the fields of `{register}` do not suit its access: {rule}")]
    Fields {
        /// The register.
        register: String,
        /// What must hold.
        rule: &'static str,
    },
}
