//! What a register map is made of: plain data, to be checked by [`RegisterMap::new`](super::RegisterMap::new).
//!
//! A name is one name everywhere: a register `index_gate` is `INDEX_GATE` in Verilog and C, a field `mode` is the bank's port
//! `mode`, which [composition](crate::rtl::composition) connects to the core's port `mode`.

/// Words of a window on the bus: a component has one, a stage one of its own and one per axis.
pub const WINDOW_WORDS: u32 = 256;
/// Most windows of a map: the stage's and those of four axes.
pub const MOST_WINDOWS: u32 = 5;
/// Bits of a word.
pub const WORD_BITS: u32 = 32;

/// All registers of a component.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// The component's name, lower-case snake case.
    pub name: String,
    /// What the component is, in a sentence.
    pub about: String,
    /// Windows of [`WINDOW_WORDS`] words, 1 to [`MOST_WINDOWS`].
    pub windows: u32,
    /// Its registers. The first are constants: `magic` at 0, `version` at 1, then the build's parameters.
    pub registers: Vec<Register>,
}

/// One 32-bit word.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Register {
    /// Name, lower-case snake case.
    pub name: String,
    /// Place in the window, in words.
    pub offset: u32,
    /// What reads and writes do.
    pub access: Access,
    /// What it is for.
    pub meaning: String,
    /// Its fields; bits of none read as 0.
    pub fields: Vec<Field>,
}

/// What reads and writes of a register do, and what the hardware sees.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Access {
    /// Reads as its fields' reset values, for ever.
    Constant,
    /// Reads as the hardware inputs of its fields' names in the clock of the read.
    Live,
    /// Reads as the live register `of` was when [`Access::Snapshot`] was last written. It has the fields of that register.
    Shadow {
        /// The live register's name.
        of: String,
    },
    /// Read and write, by bytes; fields are outputs.
    Configuration,
    /// As configuration, while the one-bit input is low; else writes are refused and flagged. So is a write that would put
    /// a field below its minimum.
    Guarded {
        /// Name of the input.
        while_low: String,
    },
    /// Read and write, by bytes; the fields' outputs take it when a commit is applied. Refused while one waits.
    Staged,
    /// Write only, whole words: the strobe output is high for one clock, with the fields' outputs, which then stay.
    Command {
        /// Name of the strobe.
        strobe: String,
    },
    /// As a command, at so many words in a row, a power of two, the first at a multiple of it. The port `word` says which
    /// of them was written: the entry of a FIFO, or a row of a memory.
    Words {
        /// Name of the strobe.
        strobe: String,
        /// Name of the port with the word's place, 0 to `words` − 1.
        word: String,
        /// How many words: 2, 4, … 64.
        words: u32,
    },
    /// Each field is a sticky flag of one bit: set while its [`FlagSource`] is high, cleared by writing one; set wins.
    Sticky,
    /// A whole word of any value asks for a commit, which the next `tick` applies: all staged registers at once. Its one
    /// field reads as one while a commit waits.
    Commit {
        /// Name of the one-bit input that applies it.
        tick: String,
    },
    /// A whole word of any value freezes all live registers that have a shadow.
    Snapshot,
    /// As sticky; the component's `irq` is high while an enabled flag is set.
    InterruptState,
    /// Read and write, by bytes: which flags of [`Access::InterruptState`] raise `irq`.
    InterruptEnable,
    /// Write only, whole words: sets the flags that are written as one.
    InterruptTest,
}

/// Some bits of a register.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Name, lower-case snake case.
    pub name: String,
    /// Its lowest bit.
    pub low: u32,
    /// Its width in bits.
    pub width: u32,
    /// Value after reset and at power-up.
    pub reset: u32,
    /// What it is for.
    pub meaning: String,
    /// Unit, or nothing.
    pub unit: String,
    /// How its bits are a number.
    pub format: Format,
    /// Of flags: what sets it.
    pub source: FlagSource,
    /// Of guarded fields: the smallest value that a write may give, unsigned.
    pub minimum: u32,
}

/// How a field's bits are a number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Format {
    /// A natural number.
    Unsigned,
    /// Two's complement.
    Signed,
    /// Two's complement, so many bits of it behind the point.
    Fixed {
        /// Fraction bits.
        fraction: u32,
    },
    /// One bit: yes or no.
    Flag,
    /// One of these; others are not to be written.
    Enumeration(Vec<Choice>),
}

/// A value of an enumeration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// The value.
    pub value: u32,
    /// Its name, lower-case snake case.
    pub name: String,
    /// What it does.
    pub meaning: String,
}

/// What sets a flag.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlagSource {
    /// The input of the field's name.
    Input,
    /// A write of a part of a word that only takes whole words.
    PartialWrite,
    /// A write of a guarded register while that was not allowed, or below a minimum.
    GuardRefused,
    /// A commit, or a write of a staged register, while a commit waits.
    CommitRejected,
}

impl Description {
    /// `magic` (four letters, the first in the lowest byte), `version` (major in the upper half word), and a word for each
    /// of the build's parameters; other registers are added by [`with`](Self::with).
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
                "what stands here",
                vec![
                    Field::new("magic", 0, 32, &format!("the letters {letters}, first lowest"))
                        .with_reset(u32::from_le_bytes(magic)),
                ],
            ),
            constant(
                "version",
                1,
                "of this register map",
                vec![
                    Field::new("minor", 0, 16, "counts additions").with_reset(version.1.into()),
                    Field::new("major", 16, 16, "counts what breaks a driver").with_reset(version.0.into()),
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

    /// With so many windows.
    #[must_use]
    pub fn with_windows(mut self, windows: u32) -> Self {
        self.windows = windows;
        self
    }

    /// Adds a register.
    #[must_use]
    pub fn with(mut self, name: &str, offset: u32, access: Access, meaning: &str, fields: Vec<Field>) -> Self {
        self.registers.push(Register {
            name: name.to_owned(),
            offset,
            access,
            meaning: meaning.to_owned(),
            fields,
        });
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

    /// Adds `interrupt_state`, `interrupt_enable` and `interrupt_test` at `offset` and the two words after it.
    #[must_use]
    pub fn with_interrupts(self, offset: u32, fields: Vec<Field>) -> Self {
        self.with(
            "interrupt_state",
            offset,
            Access::InterruptState,
            "what has happened; write one to clear",
            fields.clone(),
        )
        .with(
            "interrupt_enable",
            offset + 1,
            Access::InterruptEnable,
            "what of it raises `irq`",
            fields.clone(),
        )
        .with(
            "interrupt_test",
            offset + 2,
            Access::InterruptTest,
            "sets the flags that are written as one",
            fields,
        )
    }
}

impl Field {
    /// An unsigned number, 0 after reset, without unit.
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

    /// One bit.
    pub fn flag(name: &str, low: u32, meaning: &str) -> Self {
        Self::new(name, low, 1, meaning).with_format(Format::Flag)
    }

    /// One of some values, each with its name and meaning.
    pub fn choice(name: &str, low: u32, width: u32, meaning: &str, choices: &[(u32, &str, &str)]) -> Self {
        let choices = choices.iter().map(|(value, name, meaning)| Choice {
            value: *value,
            name: (*name).to_owned(),
            meaning: (*meaning).to_owned(),
        });
        Self::new(name, low, width, meaning).with_format(Format::Enumeration(choices.collect()))
    }

    /// Two's complement.
    #[must_use]
    pub fn signed(self) -> Self {
        self.with_format(Format::Signed)
    }

    /// Two's complement with so many fraction bits.
    #[must_use]
    pub fn fixed(self, fraction: u32) -> Self {
        self.with_format(Format::Fixed { fraction })
    }

    /// With this format.
    #[must_use]
    pub fn with_format(mut self, format: Format) -> Self {
        self.format = format;
        self
    }

    /// With this value after reset.
    #[must_use]
    pub fn with_reset(mut self, reset: u32) -> Self {
        self.reset = reset;
        self
    }

    /// In this unit.
    #[must_use]
    pub fn with_unit(mut self, unit: &str) -> Self {
        unit.clone_into(&mut self.unit);
        self
    }

    /// Set by this.
    #[must_use]
    pub fn set_by(mut self, source: FlagSource) -> Self {
        self.source = source;
        self
    }

    /// Never below this.
    #[must_use]
    pub fn at_least(mut self, minimum: u32) -> Self {
        self.minimum = minimum;
        self
    }

    /// Is its port two's complement?
    pub fn is_signed(&self) -> bool {
        matches!(self.format, Format::Signed | Format::Fixed { .. })
    }

    /// Ones in as many bits as it has, at the lowest.
    pub fn ones(&self) -> u32 {
        u32::MAX.checked_shr(WORD_BITS - self.width.min(WORD_BITS)).unwrap_or(0)
    }

    /// Ones in its bits of the word.
    pub fn mask(&self) -> u32 {
        self.ones().checked_shl(self.low).unwrap_or(0)
    }

    /// What the word says about it.
    pub fn of(&self, word: u32) -> u32 {
        word.checked_shr(self.low).unwrap_or(0) & self.ones()
    }
}

impl Register {
    /// How many words it takes, from its offset on.
    pub fn words(&self) -> u32 {
        match self.access {
            Access::Words { words, .. } => words,
            _ => 1,
        }
    }

    /// Ones where it has fields of its own.
    pub fn mask(&self) -> u32 {
        self.fields.iter().fold(0, |mask, field| mask | field.mask())
    }

    /// The word of its fields' reset values.
    pub fn reset(&self) -> u32 {
        self.fields
            .iter()
            .fold(0, |word, field| word | (field.reset & field.ones()) << field.low)
    }
}

impl Access {
    /// Takes it whole words only?
    pub fn whole_words(&self) -> bool {
        matches!(
            self,
            Self::Command { .. } | Self::Words { .. } | Self::Commit { .. } | Self::Snapshot | Self::InterruptTest
        )
    }

    /// Are its fields flags that hardware sets and a one clears?
    pub fn is_sticky(&self) -> bool {
        matches!(self, Self::Sticky | Self::InterruptState)
    }

    /// Are its fields outputs of the bank?
    pub fn drives_fields(&self) -> bool {
        matches!(
            self,
            Self::Configuration | Self::Guarded { .. } | Self::Staged | Self::Command { .. } | Self::Words { .. }
        )
    }

    /// The kind, in a word or two, as the documentation says it.
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
