//! The imports of every kernel: RustHDL, with replacements for the parts that do not behave as documented, and our
//! leaves.
//!
//! An explicit re-export shadows the one of the glob, so a kernel with `use crate::prelude::*` gets our items:
//!
//! | ours | replaces |
//! |---|---|
//! | [`signed_bit_cast`] | RustHDL's, which overflows the stack on the most negative value |
//! | `kernel!` | the struct, the constructor and the wiring that every kernel would repeat; its registers replace RustHDL's `DFF` without reset |
//! | [`Ram`], [`Rom`] | RustHDL's `RAM` and `ROM` with two clocks, and without arbitrary contents |
//! | `comment!` | nothing: `#[hdl_gen]` knows the macro, but RustHDL does not define it |

pub(crate) use crate::kernel::kernel;
pub(crate) use crate::prim::{FaultLatch, PinRegister, Ram, Rom, RomWord, SMul, Synchroniser};
pub(crate) use rust_hdl_core::prelude::*;
pub(crate) use rust_hdl_macros::hdl_gen;

/// A comment in the Verilog; it does nothing in the simulation. Its text should stay below 50 characters: RustHDL
/// wraps longer text.
macro_rules! comment {
    ($($text:tt)*) => {};
}

pub(crate) use comment;

/// Sign-extends or truncates a value.
///
/// `#[hdl_gen]` identifies a function by its name alone, so shadowing RustHDL's function is enough.
pub(crate) fn signed_bit_cast<const TO: usize, const FROM: usize>(value: Signed<FROM>) -> Signed<TO> {
    let pattern = unsigned_cast(value);
    if value.sign_bit() {
        signed_cast(!bit_cast::<TO, FROM>(!pattern))
    } else {
        signed_cast(bit_cast::<TO, FROM>(pattern))
    }
}

/// The value of a signed word of `N` ≤ 64 bits.
pub(crate) fn to_i64<const N: usize>(value: Signed<N>) -> i64 {
    let pattern: u64 = unsigned_cast(value).into();
    let unused = 64 - N;
    ((pattern << unused) as i64) >> unused
}

/// The low `N` ≤ 64 bits of a number.
pub(crate) fn from_i64<const N: usize>(value: i64) -> Signed<N> {
    signed_cast(from_u64(value as u64))
}

/// The low `N` ≤ 64 bits of a number.
pub(crate) fn from_u64<const N: usize>(value: u64) -> Bits<N> {
    Bits::from(value & (u64::MAX >> (64 - N)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_extension_and_truncation_take_every_value() {
        for value in -128..128 {
            let short: Signed<8> = from_i64(value);
            assert_eq!(to_i64(short), value);
            assert_eq!(to_i64(signed_bit_cast::<16, 8>(short)), value);
            assert_eq!(to_i64(signed_bit_cast::<58, 8>(short)), value);
            assert_eq!(to_i64(signed_bit_cast::<4, 8>(short)), (value << 60) >> 60);
        }
    }

    #[test]
    fn the_ends_of_64_bits() {
        for value in [i64::MIN, -1, 0, i64::MAX] {
            assert_eq!(to_i64(from_i64::<64>(value)), value);
        }
        assert_eq!(to_i64(from_i64::<50>(-(1 << 49))), -(1 << 49));
    }
}
