//! The parts of a register map as plain data, which [`RegisterMap::new`](super::RegisterMap::new) checks.
//!
//! A name is the same everywhere: a register `index_gate` is `INDEX_GATE` in Verilog and C, a field `mode` is the
//! bank's port `mode`, which [composition](crate::composition) connects to the core's port `mode`.

/// Number of words of a window on the bus: a component has one window, a stage one of its own and one per axis.
pub const WINDOW_WORDS: u32 = 256;
/// Largest number of windows of a map: the stage's and those of four axes.
pub const MOST_WINDOWS: u32 = 5;
/// Bits of a word.
pub const WORD_BITS: u32 = 32;

/// All registers of a component.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// Name of the component, in lower-case snake case.
    pub name: String,
    /// Description of the component, in a sentence.
    pub about: String,
    /// Number of windows of [`WINDOW_WORDS`] words, 1 to [`MOST_WINDOWS`].
    pub windows: u32,
    /// Its registers. The first are constants: `magic` at 0, `version` at 1, then the parameters of the build.
    pub registers: Vec<Register>,
}

/// A register, which is one 32-bit word unless its access has several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Register {
    /// Name, in lower-case snake case.
    pub name: String,
    /// Offset in the window, in words.
    pub offset: u32,
    /// Effect of reads and writes.
    pub access: Access,
    /// Purpose of the register.
    pub meaning: String,
    /// Its fields; bits without a field read as 0.
    pub fields: Vec<Field>,
}

/// Effect of reads and writes of a register, and what the hardware sees of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Access {
    /// It always reads as its fields' reset values.
    Constant,
    /// It reads as the hardware inputs with its fields' names in the clock of the read.
    Live,
    /// It reads as the live register `of` did when [`Access::Snapshot`] was last written. It has the fields of that
    /// register.
    Shadow {
        /// Name of the live register.
        of: String,
    },
    /// Read and write, by bytes; its fields are outputs.
    Configuration,
    /// Like configuration, but a write is refused and flagged while the one-bit input is high, and if it would set a
    /// field below its minimum.
    Guarded {
        /// Name of the input.
        while_low: String,
    },
    /// Read and write, by bytes; the fields' outputs take the value when a commit is applied. Writes are refused
    /// while a commit waits.
    Staged,
    /// Write only, whole words: the strobe output is high for one clock, with the fields' outputs, which then hold
    /// their value.
    Command {
        /// Name of the strobe output.
        strobe: String,
    },
    /// Like a command, at this many consecutive words, a power of two, the first at a multiple of it. The port `word`
    /// says which of them was written: the entry of a FIFO, or a row of a memory.
    Words {
        /// Name of the strobe output.
        strobe: String,
        /// Name of the port with the index of the word, 0 to `words` − 1.
        word: String,
        /// Number of words: 2, 4, … 64.
        words: u32,
    },
    /// Each field is a sticky flag of one bit: set while its [`FlagSource`] is high, cleared by writing one; set wins.
    Sticky,
    /// A whole word of any value requests a commit, which the next `tick` applies: all staged registers take effect
    /// together. Its one field reads as one while a commit waits.
    Commit {
        /// Name of the one-bit input that applies the commit.
        tick: String,
    },
    /// A whole word of any value freezes all live registers that have a shadow.
    Snapshot,
    /// Like sticky; the component's `irq` is high while an enabled flag is set.
    InterruptState,
    /// Read and write, by bytes: enables flags of [`Access::InterruptState`] to raise `irq`.
    InterruptEnable,
    /// Write only, whole words: sets the flags whose bits are written as one.
    InterruptTest,
}

/// A field: some bits of a register.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Name, in lower-case snake case.
    pub name: String,
    /// Its lowest bit.
    pub low: u32,
    /// Its width in bits.
    pub width: u32,
    /// Value after reset and at power-up.
    pub reset: u32,
    /// Purpose of the field.
    pub meaning: String,
    /// Unit; empty where there is none.
    pub unit: String,
    /// Number format of its bits.
    pub format: Format,
    /// For flags: the source that sets it.
    pub source: FlagSource,
    /// For guarded fields: the smallest value that a write may set, unsigned.
    pub minimum: u32,
}

/// Number format of a field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Format {
    /// A natural number.
    Unsigned,
    /// Two's complement.
    Signed,
    /// Two's complement with fraction bits.
    Fixed {
        /// Number of fraction bits.
        fraction: u32,
    },
    /// One bit, true or false.
    Flag,
    /// One of these values; others must not be written.
    Enumeration(Vec<Choice>),
}

/// A value of an enumeration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// The value.
    pub value: u32,
    /// Its name, lower-case snake case.
    pub name: String,
    /// Effect of the value.
    pub meaning: String,
}

/// Source that sets a flag.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlagSource {
    /// The input with the field's name.
    Input,
    /// A write of part of a word to a register that takes only whole words.
    PartialWrite,
    /// A write to a guarded register while that was not allowed, or with a value below a minimum.
    GuardRefused,
    /// A commit, or a write to a staged register, while a commit waits.
    CommitRejected,
}

impl Description {
    /// Makes a description with `magic` (four letters, the first in the lowest byte), `version` (major in the upper
    /// half word), and a word for each parameter of the build; [`with`](Self::with) adds other registers.
    pub fn new(name: &str, about: &str, magic: [u8; 4], version: (u16, u16), parameters: Vec<Field>) -> Self {
        let constant = |name: &str, offset, meaning: &str, fields| Register {
            name: name.to_owned(),
            offset,
            access: Access::Constant,
            meaning: meaning.to_owned(),
            fields,
        };
        let letters = magic.escape_ascii().to_string();
        let mut registers = vec![
            constant(
                "magic",
                0,
                "identifies the component",
                vec![
                    Field::new(
                        "magic",
                        0,
                        32,
                        &format!("the letters {letters}, the first in the lowest byte"),
                    )
                    .with_reset(u32::from_le_bytes(magic)),
                ],
            ),
            constant(
                "version",
                1,
                "version of this register map",
                vec![
                    Field::new("minor", 0, 16, "goes up with additions").with_reset(version.1.into()),
                    Field::new(
                        "major",
                        16,
                        16,
                        "goes up with changes that break a \
                        driver",
                    )
                    .with_reset(version.0.into()),
                ],
            ),
        ];
        for (offset, parameter) in (2..).zip(parameters) {
            registers.push(constant(
                &parameter.name.clone(),
                offset,
                "parameter of the build",
                vec![parameter],
            ));
        }
        Self {
            name: name.to_owned(),
            about: about.to_owned(),
            windows: 1,
            registers,
        }
    }

    /// Sets the number of windows.
    #[must_use]
    pub fn with_windows(mut self, windows: u32) -> Self {
        self.windows = windows;
        self
    }

    /// Adds a register.
    #[must_use]
    pub fn with(self, name: &str, offset: u32, access: Access, meaning: &str, fields: Vec<Field>) -> Self {
        self.with_register(Register::new(name, offset, access, meaning, fields))
    }

    /// Adds a register.
    #[must_use]
    pub fn with_register(mut self, register: Register) -> Self {
        self.registers.push(register);
        self
    }

    /// Adds a live register, and at `shadow_offset` its shadow `snapshot_NAME`.
    #[must_use]
    pub fn with_shadowed(self, name: &str, offset: u32, shadow_offset: u32, meaning: &str, fields: Vec<Field>) -> Self {
        let of = name.to_owned();
        self.with(name, offset, Access::Live, meaning, fields).with(
            &format!("snapshot_{name}"),
            shadow_offset,
            Access::Shadow { of },
            &format!("{meaning}, at the snapshot"),
            Vec::new(),
        )
    }

    /// Adds `time_stamp` and `tick_count` at `offset` and the word after it, and their shadows at `shadow_offset` and the word after it.
    #[must_use]
    pub fn with_times(self, offset: u32, shadow_offset: u32) -> Self {
        let count = |name: &str, unit: &str| vec![Field::new(name, 0, 32, "modulo 2^32").with_unit(unit)];
        self.with_shadowed(
            "time_stamp",
            offset,
            shadow_offset,
            "clocks since reset",
            count("time_stamp", "clocks"),
        )
        .with_shadowed(
            "tick_count",
            offset + 1,
            shadow_offset + 1,
            "ticks since reset",
            count("tick_count", "ticks"),
        )
    }

    /// Adds `interrupt_state`, `interrupt_enable` and `interrupt_test` at `offset` and the two words after it.
    #[must_use]
    pub fn with_interrupts(self, offset: u32, fields: Vec<Field>) -> Self {
        self.with(
            "interrupt_state",
            offset,
            Access::InterruptState,
            "events since they were cleared; write one to clear",
            fields.clone(),
        )
        .with(
            "interrupt_enable",
            offset + 1,
            Access::InterruptEnable,
            "events that raise `irq`",
            fields.clone(),
        )
        .with(
            "interrupt_test",
            offset + 2,
            Access::InterruptTest,
            "sets the flags whose bits are written as one",
            fields,
        )
    }
}

impl Field {
    /// An unsigned field, 0 after reset, without unit.
    pub fn new(name: &str, low: u32, width: u32, meaning: &str) -> Self {
        Self {
            name: name.to_owned(),
            low,
            width,
            reset: 0,
            meaning: meaning.to_owned(),
            unit: String::new(),
            format: Format::Unsigned,
            source: FlagSource::Input,
            minimum: 0,
        }
    }

    /// A one-bit flag.
    pub fn flag(name: &str, low: u32, meaning: &str) -> Self {
        Self::new(name, low, 1, meaning).with_format(Format::Flag)
    }

    /// A field with a list of values, each with its name and meaning.
    pub fn choice(name: &str, low: u32, width: u32, meaning: &str, choices: &[(u32, &str, &str)]) -> Self {
        let choices = choices.iter().map(|(value, name, meaning)| Choice {
            value: *value,
            name: (*name).to_owned(),
            meaning: (*meaning).to_owned(),
        });
        Self::new(name, low, width, meaning).with_format(Format::Enumeration(choices.collect()))
    }

    /// Makes the format two's complement.
    #[must_use]
    pub fn signed(self) -> Self {
        self.with_format(Format::Signed)
    }

    /// Makes the format two's complement with this many fraction bits.
    #[must_use]
    pub fn fixed(self, fraction: u32) -> Self {
        self.with_format(Format::Fixed { fraction })
    }

    /// Sets the format.
    #[must_use]
    pub fn with_format(mut self, format: Format) -> Self {
        self.format = format;
        self
    }

    /// Sets the value after reset.
    #[must_use]
    pub fn with_reset(mut self, reset: u32) -> Self {
        self.reset = reset;
        self
    }

    /// Sets the unit.
    #[must_use]
    pub fn with_unit(mut self, unit: &str) -> Self {
        unit.clone_into(&mut self.unit);
        self
    }

    /// Sets the source of a flag.
    #[must_use]
    pub fn set_by(mut self, source: FlagSource) -> Self {
        self.source = source;
        self
    }

    /// Sets the smallest value.
    #[must_use]
    pub fn at_least(mut self, minimum: u32) -> Self {
        self.minimum = minimum;
        self
    }

    /// Whether its port is two's complement.
    pub fn is_signed(&self) -> bool {
        matches!(self.format, Format::Signed | Format::Fixed { .. })
    }

    /// A mask of its width, at the lowest bits.
    pub fn ones(&self) -> u32 {
        u32::MAX.checked_shr(WORD_BITS - self.width.min(WORD_BITS)).unwrap_or(0)
    }

    /// A mask of its bits in the word.
    pub fn mask(&self) -> u32 {
        self.ones().checked_shl(self.low).unwrap_or(0)
    }

    /// The field's value in a word.
    pub fn of(&self, word: u32) -> u32 {
        word.checked_shr(self.low).unwrap_or(0) & self.ones()
    }
}

impl Access {
    /// A command whose strobe has this name.
    pub(crate) fn command(strobe: &str) -> Self {
        Self::Command {
            strobe: strobe.to_owned(),
        }
    }
}

impl Register {
    /// Describes a register.
    pub fn new(name: &str, offset: u32, access: Access, meaning: &str, fields: Vec<Field>) -> Self {
        Self {
            name: name.to_owned(),
            offset,
            access,
            meaning: meaning.to_owned(),
            fields,
        }
    }

    /// Number of words that it takes, from its offset on.
    pub fn words(&self) -> u32 {
        match self.access {
            Access::Words { words, .. } => words,
            _ => 1,
        }
    }

    /// A mask of all its fields.
    pub fn mask(&self) -> u32 {
        self.fields.iter().fold(0, |mask, field| mask | field.mask())
    }

    /// The word with its fields' reset values.
    pub fn reset(&self) -> u32 {
        self.fields
            .iter()
            .fold(0, |word, field| word | (field.reset & field.ones()) << field.low)
    }
}

impl Access {
    /// Whether it takes only whole words.
    pub fn whole_words(&self) -> bool {
        matches!(
            self,
            Self::Command { .. } | Self::Words { .. } | Self::Commit { .. } | Self::Snapshot | Self::InterruptTest
        )
    }

    /// Whether its fields are flags that the hardware sets and that are cleared by writing one.
    pub fn is_sticky(&self) -> bool {
        matches!(self, Self::Sticky | Self::InterruptState)
    }

    /// Whether its fields are outputs of the bank.
    pub fn drives_fields(&self) -> bool {
        matches!(
            self,
            Self::Configuration | Self::Guarded { .. } | Self::Staged | Self::Command { .. } | Self::Words { .. }
        )
    }

    /// Kind of access in a word or two, as the documentation states it.
    pub fn words(&self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Live => "live",
            Self::Shadow { .. } => "shadow",
            Self::Configuration => "configuration",
            Self::Guarded { .. } => "guarded",
            Self::Staged => "staged",
            Self::Command { .. } => "command",
            Self::Words { .. } => "command words",
            Self::Sticky => "sticky",
            Self::Commit { .. } => "commit",
            Self::Snapshot => "snapshot",
            Self::InterruptState => "interrupt state",
            Self::InterruptEnable => "interrupt enable",
            Self::InterruptTest => "interrupt test",
        }
    }
}
