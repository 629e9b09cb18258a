//! Register banks: one description of a component's registers, from which bank, model and documents are made.
//!
//! ```text
//! Description ─► RegisterMap ─┬─► RegisterBank          this crate: the bank, clock by clock
//! (maps/)        (checked)    ├─► markdown              docs/TOP.md of a package
//!                             └─► Verilog               posicast_hdl::registers
//! ```
//!
//! The datasheet is `docs/registers.md`; the hardware is compared with the reference model [`RegisterBank`].
//!
//! ```
//! use posicast_blocks::ClockedBlock;
//! use posicast_blocks::registers::{Access, Description, Field, RegisterBank, RegisterMap};
//!
//! let map = RegisterMap::new(
//!     Description::new("lamp", "A lamp.", *b"LAMP", (1, 0), vec![]).with(
//!         "brightness",
//!         4,
//!         Access::Configuration,
//!         "how bright it is",
//!         vec![Field::new("level", 0, 8, "brightness").with_reset(7)],
//!     ),
//! )?;
//! // rst, address, read, write, byte enables, data; read data and the port of the field.
//! let (mut bank, mut outputs) = (RegisterBank::new(&map), [0; 2]);
//! bank.step(&[0, 4, 0, 1, 0xf, 200], &mut outputs)?;
//! assert_eq!(outputs, [0, 7]);
//! bank.step(&[0, 4, 1, 0, 0xf, 0], &mut outputs)?;
//! bank.step(&[0, 0, 0, 0, 0xf, 0], &mut outputs)?;
//! assert_eq!(outputs, [200, 200]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bank;
mod check;
mod description;
mod error;
mod map;
pub mod maps;
mod markdown;
pub(crate) mod tables;
pub(crate) mod trace;

pub use bank::RegisterBank;
pub use description::{
    Access, Choice, Description, Field, FlagSource, Format, MOST_WINDOWS, Register, WINDOW_WORDS, WORD_BITS,
};
pub use error::MapError;
pub use map::RegisterMap;
pub use markdown::markdown;
