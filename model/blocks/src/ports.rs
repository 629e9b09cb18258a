//! `ports!`: a block's ports, written once.
//!
//! ```text
//! ports! {
//!     counter_ports;                                  name of the list, for the block's kernel in `hdl`
//!
//!     /// The input ports.
//!     inputs Inputs {
//!         /// Synchronous reset.
//!         rst: Bit as bool;
//!         /// Value at which the count restarts.
//!         limit: Bits(8) as u8, "counts";             with a unit
//!         /// What a trace can show.
//!         signal[16]: Signed(32) as i32;              `signal_0` to `signal_15`, in Rust an array
//!     }
//!
//!     /// The output ports.
//!     outputs Outputs {
//!         ...
//!     }
//! }
//! ```
//!
//! An entry has a port's name, its type in the hardware and in Rust, its unit if it has one, and above them, as its
//! documentation, its meaning in a sentence. `clk` is not listed. From the list come:
//!
//! - the structs `Inputs` and `Outputs` with a field per port, and their conversion from and to raw bit patterns
//!   (`from_raw`, `to_raw`);
//! - `INPUT_PORTS` and `OUTPUT_PORTS`, the numbers of ports; `ports()` for [`ClockedBlock`](super::ClockedBlock); and
//!   `PORTS` with units and meanings, from which the datasheet's table is made;
//! - the macro `posicast_blocks::counter_ports!`, from which `kernel!` in `hdl` makes the kernel's fields and raw
//!   ports.
//!
//! Where a number of ports, or a width, is a size of the block, the sizes follow the list's name, the structs and the
//! Rust types are left out, and `ports` takes the sizes. The kernel has sizes of the same names:
//!
//! ```text
//! ports! {
//!     group_ports(N);
//!
//!     inputs {
//!         /// Synchronous reset.
//!         rst: Bit;
//!         /// Of the axis: its `can_start`.
//!         can_start[N]: Bit;
//!     }
//!
//!     outputs { ... }
//! }
//! ```
//!
//! Where only widths are sizes, the structs and Rust types may be given too; `from_raw` and `to_raw` then take the
//! sizes.
//!
//! [`clocked_block!`] makes a model with such a list a [`ClockedBlock`](super::ClockedBlock). A type that implements
//! [`PortValue`], an enum for example, may follow `as`; `choices!` implements it for an enum.

use super::{Direction, Port};

/// A port as its block's list describes it. An array of ports is one row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PortRow {
    /// Name, as in the Verilog; for an array without the index.
    pub name: &'static str,
    /// Number of ports of an array, which are called `name_0`, `name_1`, …; `None` for a single port.
    pub count: Option<usize>,
    /// Direction.
    pub direction: Direction,
    /// Width in bits, 1..=64.
    pub width: u32,
    /// Whether the value is a two's complement number.
    pub signed: bool,
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// The lines of the entry's documentation.
    pub meaning: &'static [&'static str],
}

/// A port of a list with sizes, as the datasheet shows it: like [`PortRow`], with names of sizes in place of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SizedPortRow {
    /// Name, as in the Verilog; for an array without the index.
    pub name: &'static str,
    /// Name of the size that is the number of ports of an array; `None` for a single port.
    pub count: Option<&'static str>,
    /// Direction.
    pub direction: Direction,
    /// Width in bits: a number, or the name of a size.
    pub width: &'static str,
    /// Whether the value is a two's complement number.
    pub signed: bool,
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// The lines of the entry's documentation.
    pub meaning: &'static [&'static str],
}

/// All ports of a block, inputs first, in the order of the Verilog's port list, without `clk`.
pub type PortList = &'static [PortRow];

/// Purpose of a port, as the text of a comment beside it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortNote {
    /// The port; of an array the first.
    pub port: String,
    /// The first sentence of its meaning, and its unit in brackets where that does not name it.
    pub text: String,
}

/// A row of a list, with or without sizes.
pub trait DescribedPort {
    /// Returns the purpose of the port.
    fn note(&self) -> PortNote;
}

impl DescribedPort for PortRow {
    fn note(&self) -> PortNote {
        note(self.name, self.count.is_some(), self.meaning, self.unit)
    }
}

impl DescribedPort for SizedPortRow {
    fn note(&self) -> PortNote {
        note(self.name, self.count.is_some(), self.meaning, self.unit)
    }
}

fn note(name: &str, is_array: bool, meaning: &[&str], unit: &str) -> PortNote {
    let meaning: Vec<&str> = meaning.iter().map(|line| line.trim()).collect();
    let meaning = meaning.join(" ");
    let sentence = meaning.split(". ").next().unwrap_or_default().trim_end_matches('.');
    PortNote {
        port: format!("{name}{}", if is_array { "_0" } else { "" }),
        text: if sentence.to_lowercase().contains(unit) {
            sentence.to_owned()
        } else {
            format!("{sentence} [{unit}]")
        },
    }
}

/// Characters outside ASCII that documentation of ports and kernels has, and their replacements.
const WORDS: [(char, &str); 12] = [
    ('−', "-"),
    ('·', "*"),
    ('×', "x"),
    ('…', "..."),
    ('Σ', "sum of"),
    ('±', "+/-"),
    ('≥', ">="),
    ('≤', "<="),
    ('λ', "lambda"),
    ('ω', "omega"),
    ('²', "^2"),
    ('│', "|"),
];

/// A text of the documentation for a comment in Verilog, which some tools cannot read outside ASCII.
pub fn in_ascii(text: &str) -> String {
    WORDS.iter().fold(text.to_owned(), |text, (letter, instead)| {
        text.replace(*letter, instead)
    })
}

/// Returns the purpose of each port of a list, in its order.
pub fn port_notes(list: &[impl DescribedPort]) -> Vec<PortNote> {
    list.iter().map(DescribedPort::note).collect()
}

impl PortRow {
    /// Number of ports in the row.
    const fn ports(&self) -> usize {
        match self.count {
            Some(count) => count,
            None => 1,
        }
    }
}

/// Number of ports with a direction.
pub(crate) const fn count(list: &[PortRow], inputs: bool) -> usize {
    let (mut ports, mut row) = (0, 0);
    while row < list.len() {
        if matches!(list[row].direction, Direction::Input) == inputs {
            ports += list[row].ports();
        }
        row += 1;
    }
    ports
}

/// The ports of a list, with those of an array one by one.
pub(crate) fn listed(list: &[PortRow]) -> Vec<Port> {
    let row = |row: &PortRow| {
        let row = *row;
        (0..row.ports()).map(move |index| Port {
            name: row
                .count
                .map_or_else(|| row.name.to_owned(), |_| format!("{}_{index}", row.name)),
            direction: row.direction,
            width: row.width,
            signed: row.signed,
        })
    };
    list.iter().flat_map(row).collect()
}

/// Conversion of a port's value between Rust and its raw bit pattern.
pub(crate) trait PortValue: Copy + Default {
    /// Converts the pattern of a port of this width; bits above are ignored.
    fn from_pattern(pattern: u64, width: u32, signed: bool) -> Self;
    /// The pattern of the value, which may have bits above the port's width.
    fn pattern(self) -> u64;
}

impl PortValue for bool {
    #[inline]
    fn from_pattern(pattern: u64, _: u32, _: bool) -> Self {
        pattern & 1 != 0
    }

    #[inline]
    fn pattern(self) -> u64 {
        self.into()
    }
}

macro_rules! whole_numbers {
    ($($number:ty),*) => {
        $(impl PortValue for $number {
            #[inline]
            fn from_pattern(pattern: u64, width: u32, signed: bool) -> Self {
                let above = 64 - width;
                if signed {
                    ((pattern << above) as i64 >> above) as Self
                } else {
                    (pattern << above >> above) as Self
                }
            }

            #[inline]
            fn pattern(self) -> u64 {
                self as u64
            }
        })*
    };
}

whole_numbers!(u8, u16, u32, u64, i32, i64);

/// Implements [`PortValue`] for an enum. A pattern that is no value of it becomes the first value.
macro_rules! choices {
    ($choice:ident: $first:ident $(, $other:ident)*) => {
        impl $crate::ports::PortValue for $choice {
            #[inline]
            fn from_pattern(pattern: u64, width: u32, _: bool) -> Self {
                let pattern = pattern & (u64::MAX >> (64 - width));
                [$(Self::$other),*].into_iter().find(|other| *other as u64 == pattern).unwrap_or(Self::$first)
            }

            #[inline]
            fn pattern(self) -> u64 {
                self as u64
            }
        }
    };
}

/// See the [module](self).
macro_rules! ports {
    (
        $list:ident;

        $(#[$of_inputs:meta])*
        inputs $inputs:ident {
            $($(#[doc = $input_meaning:literal])+
            $input:ident $([$input_count:literal])?: $input_kind:ident $(($input_width:literal))? as $input_type:ty
                $(, $input_unit:literal)?;)*
        }

        $(#[$of_outputs:meta])*
        outputs $outputs:ident {
            $($(#[doc = $output_meaning:literal])+
            $output:ident $([$output_count:literal])?: $output_kind:ident $(($output_width:literal))? as $output_type:ty
                $(, $output_unit:literal)?;)*
        }
    ) => {
        $(#[$of_inputs])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
        pub struct $inputs {
            $($(#[doc = $input_meaning])+
            pub $input: $crate::ports::one_or_array!($input_type $(; $input_count)?),)*
        }

        $(#[$of_outputs])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
        pub struct $outputs {
            $($(#[doc = $output_meaning])+
            pub $output: $crate::ports::one_or_array!($output_type $(; $output_count)?),)*
        }

        /// The ports with their units and meanings.
        pub const PORTS: $crate::PortList = &[
            $($crate::ports::row!(
                Input $input [$($input_count)?] $input_kind ($($input_width)?) [$($input_unit)?] [$($input_meaning),+]
            ),)*
            $($crate::ports::row!(
                Output $output [$($output_count)?] $output_kind ($($output_width)?) [$($output_unit)?] [$($output_meaning),+]
            ),)*
        ];
        /// Number of input ports, without `clk`.
        pub const INPUT_PORTS: usize = $crate::ports::count(PORTS, true);
        /// Number of output ports.
        pub const OUTPUT_PORTS: usize = $crate::ports::count(PORTS, false);

        /// The ports in the order of the Verilog's port list, without `clk`.
        pub fn ports() -> Vec<$crate::Port> {
            $crate::ports::listed(PORTS)
        }

        $crate::ports::raw! { $inputs INPUT_PORTS () $($input: $input_kind ($($input_width)?) [$($input_count)?];)* }
        $crate::ports::raw! { $outputs OUTPUT_PORTS () $($output: $output_kind ($($output_width)?) [$($output_count)?];)* }

        $crate::ports::list! {
            $list
            { $($input $([$input_count])?: $input_kind $(<$input_width>)?),* }
            { $($output $([$output_count])?: $output_kind $(<$output_width>)?),* }
        }
    };
    (
        $list:ident($($size:ident),+);

        $(#[$of_inputs:meta])*
        inputs $inputs:ident {
            $($(#[doc = $input_meaning:literal])+
            $input:ident: $input_kind:ident $(($input_width:tt))? as $input_type:ty $(, $input_unit:literal)?;)*
        }

        $(#[$of_outputs:meta])*
        outputs $outputs:ident {
            $($(#[doc = $output_meaning:literal])+
            $output:ident: $output_kind:ident $(($output_width:tt))? as $output_type:ty $(, $output_unit:literal)?;)*
        }
    ) => {
        $(#[$of_inputs])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
        pub struct $inputs {
            $($(#[doc = $input_meaning])+
            pub $input: $input_type,)*
        }

        $(#[$of_outputs])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
        pub struct $outputs {
            $($(#[doc = $output_meaning])+
            pub $output: $output_type,)*
        }

        /// Number of input ports, without `clk`.
        pub const INPUT_PORTS: usize = [$(stringify!($input)),*].len();
        /// Number of output ports.
        pub const OUTPUT_PORTS: usize = [$(stringify!($output)),*].len();

        $crate::ports::raw! { $inputs INPUT_PORTS ($($size),+) $($input: $input_kind ($($input_width)?) [];)* }
        $crate::ports::raw! { $outputs OUTPUT_PORTS ($($size),+) $($output: $output_kind ($($output_width)?) [];)* }

        $crate::ports::ports! {
            $list($($size),+);

            inputs { $($(#[doc = $input_meaning])+ $input: $input_kind $(($input_width))? $(, $input_unit)?;)* }

            outputs { $($(#[doc = $output_meaning])+ $output: $output_kind $(($output_width))? $(, $output_unit)?;)* }
        }
    };
    (
        $list:ident($($size:ident),+);

        inputs {
            $($(#[doc = $input_meaning:literal])+
            $input:ident $([$input_count:ident])?: $input_kind:ident $(($input_width:tt))? $(, $input_unit:literal)?;)*
        }

        outputs {
            $($(#[doc = $output_meaning:literal])+
            $output:ident $([$output_count:ident])?: $output_kind:ident $(($output_width:tt))? $(, $output_unit:literal)?;)*
        }
    ) => {
        /// The ports with their units and meanings, in terms of the sizes.
        pub const PORTS: &[$crate::SizedPortRow] = &[
            $($crate::ports::sized_row!(
                Input $input [$($input_count)?] $input_kind ($($input_width)?) [$($input_unit)?] [$($input_meaning),+]
            ),)*
            $($crate::ports::sized_row!(
                Output $output [$($output_count)?] $output_kind ($($output_width)?) [$($output_unit)?]
                [$($output_meaning),+]
            ),)*
        ];

        /// The ports in the order of the Verilog's port list, without `clk`, for these sizes.
        #[expect(non_snake_case, reason = "a size has its name in the kernel")]
        pub fn ports($($size: usize),+) -> Vec<$crate::Port> {
            $crate::ports::listed(&[
                $($crate::ports::row!(
                    Input $input [$($input_count)?] $input_kind ($($input_width)?) [$($input_unit)?] [$($input_meaning),+]
                ),)*
                $($crate::ports::row!(
                    Output $output [$($output_count)?] $output_kind ($($output_width)?) [$($output_unit)?]
                    [$($output_meaning),+]
                ),)*
            ])
        }

        $crate::ports::list! {
            $list
            { $($input $([$input_count])?: $input_kind $(<$input_width>)?),* }
            { $($output $([$output_count])?: $output_kind $(<$output_width>)?),* }
        }
    };
}

/// The block's ports, for `kernel!` of `posicast_hdl`.
macro_rules! list {
    ($list:ident $inputs:tt $outputs:tt) => {
        /// The block's ports, for `kernel!` of `posicast_hdl`: calls the macro `then` with them, and with what else it is given.
        #[macro_export]
        macro_rules! $list {
            ($then:ident $header:tt $sections:tt) => {
                $then! { @ports $inputs $outputs $header $sections }
            };
        }
    };
}

/// The Rust type of an entry.
macro_rules! one_or_array {
    ($one:ty) => {
        $one
    };
    ($one:ty; $count:literal) => {
        [$one; $count]
    };
}

/// A row of `PORTS`.
macro_rules! row {
    ($direction:ident $name:ident [$($count:tt)?] $kind:ident $width:tt [$($unit:literal)?] [$($meaning:literal),+]) => {
        $crate::PortRow {
            name: stringify!($name),
            count: $crate::ports::optional!($($count)?),
            direction: $crate::Direction::$direction,
            width: $crate::ports::width!($kind $width),
            signed: $crate::ports::signed!($kind),
            unit: concat!("" $(, $unit)?),
            meaning: &[$($meaning),+],
        }
    };
}

/// A row of `PORTS` of a list with sizes.
macro_rules! sized_row {
    (
        $direction:ident $name:ident [$($count:ident)?] $kind:ident ($($width:tt)?) [$($unit:literal)?]
        [$($meaning:literal),+]
    ) => {
        $crate::SizedPortRow {
            name: stringify!($name),
            count: $crate::ports::optional!($(stringify!($count))?),
            direction: $crate::Direction::$direction,
            width: $crate::ports::width_text!($($width)?),
            signed: $crate::ports::signed!($kind),
            unit: concat!("" $(, $unit)?),
            meaning: &[$($meaning),+],
        }
    };
}

macro_rules! width_text {
    () => {
        "1"
    };
    ($width:tt) => {
        stringify!($width)
    };
}

macro_rules! optional {
    () => {
        None
    };
    ($value:expr) => {
        Some($value)
    };
}

macro_rules! width {
    (Bit ()) => {
        1
    };
    ($kind:ident ($width:literal)) => {
        $width
    };
    ($kind:ident ($size:ident)) => {
        $size as u32
    };
}

macro_rules! signed {
    (Signed) => {
        true
    };
    ($unsigned:ident) => {
        false
    };
}

/// Conversion between a struct of ports and its raw bit patterns.
macro_rules! raw {
    ($ports:ident $number:ident ($($size:ident),*) $($name:ident: $kind:ident $width:tt [$($count:literal)?];)*) => {
        impl $ports {
            /// Converts raw bit patterns, one per port in port order; bits above a port's width are ignored.
            #[inline]
            #[allow(non_snake_case, reason = "a size has its name in the kernel")]
            pub fn from_raw(raw: &[u64; $number] $(, $size: usize)*) -> Self {
                let mut next = 0;
                let mut pattern = || {
                    next += 1;
                    raw[next - 1]
                };
                Self {
                    $($name: $crate::ports::from_raw!(pattern $kind $width [$($count)?]),)*
                }
            }

            /// The raw bit patterns, one per port in port order, each cut to its port's width.
            #[inline]
            #[allow(non_snake_case, reason = "a size has its name in the kernel")]
            pub fn to_raw(&self $(, $size: usize)*) -> [u64; $number] {
                let mut raw = [0; $number];
                let mut next = 0;
                let mut put = |pattern: u64, width: u32| {
                    raw[next] = pattern & (u64::MAX >> (64 - width));
                    next += 1;
                };
                $($crate::ports::to_raw!(put self.$name, $kind $width [$($count)?]);)*
                raw
            }
        }
    };
}

macro_rules! from_raw {
    ($pattern:ident $kind:ident $width:tt []) => {
        $crate::ports::PortValue::from_pattern(
            $pattern(),
            $crate::ports::width!($kind $width),
            $crate::ports::signed!($kind),
        )
    };
    ($pattern:ident $kind:ident $width:tt [$count:literal]) => {
        std::array::from_fn(|_| $crate::ports::from_raw!($pattern $kind $width []))
    };
}

macro_rules! to_raw {
    ($put:ident $value:expr, $kind:ident $width:tt []) => {
        $put($crate::ports::PortValue::pattern($value), $crate::ports::width!($kind $width))
    };
    ($put:ident $value:expr, $kind:ident $width:tt [$count:literal]) => {
        for value in $value {
            $crate::ports::to_raw!($put value, $kind $width [])
        }
    };
}

/// Implements [`ClockedBlock`](super::ClockedBlock) for a model with `Inputs`, `Outputs` and
/// `step(&Inputs) -> Outputs`. `what` names the model in the message for a wrong number of values.
macro_rules! clocked_block {
    ($block:ident, $what:literal) => {
        impl $crate::ClockedBlock for $block {
            fn ports(&self) -> &[$crate::Port] {
                static SHARED: std::sync::LazyLock<Vec<$crate::Port>> = std::sync::LazyLock::new(ports);
                &SHARED
            }

            fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), $crate::StepError> {
                let shown = $block::step(self, &Inputs::checked(inputs, outputs)?);
                outputs.copy_from_slice(&shown.to_raw());
                Ok(())
            }

            fn advance(&mut self, inputs: &[u64], scratch: &mut [u64]) -> Result<(), $crate::StepError> {
                $block::step(self, &Inputs::checked(inputs, scratch)?);
                Ok(())
            }
        }

        impl Inputs {
            fn checked(inputs: &[u64], outputs: &[u64]) -> Result<Self, $crate::StepError> {
                match (<&[u64; INPUT_PORTS]>::try_from(inputs), outputs.len()) {
                    (Ok(raw), OUTPUT_PORTS) => Ok(Self::from_raw(raw)),
                    _ => Err($crate::StepError(format!(
                        "{} inputs and {} outputs: {} has {INPUT_PORTS} and {OUTPUT_PORTS}",
                        inputs.len(),
                        outputs.len(),
                        $what
                    ))),
                }
            }
        }
    };
}

pub(crate) use {
    choices, clocked_block, from_raw, list, one_or_array, optional, ports, raw, row, signed, sized_row, to_raw, width,
    width_text,
};
