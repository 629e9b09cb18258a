//! Width and sign of a signal, and sized literals that stand for exactly one bit pattern.

use posicast_blocks::Port;
use std::fmt;

/// Type of a signal or expression: 1 to 64 bits, unsigned or two's complement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Type {
    /// Width in bits, 1..=64.
    pub width: u32,
    /// Whether it is two's complement.
    pub signed: bool,
}

/// The type of conditions.
pub(super) const BIT: Type = Type {
    width: 1,
    signed: false,
};

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}<{}>", if self.signed { "Signed" } else { "Bits" }, self.width)
    }
}

impl Type {
    /// The unsigned type of `width` bits.
    pub fn bits(width: u32) -> Self {
        Self { width, signed: false }
    }

    /// The type of a port.
    pub fn of(port: &Port) -> Self {
        Self {
            width: port.width,
            signed: port.signed,
        }
    }

    /// A mask of all bits of the type.
    pub(super) fn mask(self) -> u64 {
        mask(0, self.width)
    }

    /// `value` as a bit pattern of this type; `None` if it does not fit.
    pub(super) fn pattern(self, value: i128) -> Option<u64> {
        let (low, high) = if self.signed {
            (-(1i128 << (self.width - 1)), (1i128 << (self.width - 1)) - 1)
        } else {
            (0, (1i128 << self.width) - 1)
        };
        (low..=high).contains(&value).then_some((value as u64) & self.mask())
    }

    /// The number that a bit pattern of this type represents.
    pub(super) fn value(self, pattern: u64) -> i128 {
        let sign_bit = 1u64 << (self.width - 1);
        let turn = if self.signed && pattern & sign_bit != 0 {
            1i128 << self.width
        } else {
            0
        };
        i128::from(pattern) - turn
    }

    /// The declaration, such as `signed [7:0]`; empty for a single unsigned bit.
    pub fn declaration(self) -> String {
        let sign = if self.signed { "signed " } else { "" };
        let range = if self.width == 1 {
            String::new()
        } else {
            format!("[{}:0]", self.width - 1)
        };
        format!("{sign}{range}").trim_end().to_owned()
    }

    /// `pattern` as a sized literal: decimal, except for the most negative value, whose magnitude has no decimal
    /// literal.
    pub fn literal(self, pattern: u64) -> String {
        let width = self.width;
        let sign_bit = 1u64 << (width - 1);
        match (self.signed, pattern & sign_bit != 0) {
            // Numbers of more than 32 bits are usually masks, not counts.
            (false, _) if pattern > 0xffff_ffff => format!("{width}'h{pattern:x}"),
            (false, _) => format!("{width}'d{pattern}"),
            (true, false) => format!("{width}'sd{pattern}"),
            (true, true) if pattern == sign_bit => format!("{width}'sh{pattern:x}"),
            (true, true) => format!("-{width}'sd{}", (pattern ^ self.mask()).wrapping_add(1)),
        }
    }
}

/// A mask with `width` ones from bit `low` on.
pub(super) fn mask(low: u32, width: u32) -> u64 {
    let ones = if width >= 64 { u64::MAX } else { (1u64 << width) - 1 };
    ones.checked_shl(low).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_sized_and_signed() {
        let signed = Type {
            width: 16,
            signed: true,
        };
        assert_eq!(Type::bits(8).literal(240), "8'd240");
        assert_eq!(signed.literal(5), "16'sd5");
        assert_eq!(signed.literal(0xfffb), "-16'sd5");
        assert_eq!(signed.literal(0x8000), "16'sh8000");
        assert_eq!(
            Type {
                width: 64,
                signed: true
            }
            .literal(u64::MAX),
            "-64'sd1"
        );
        assert_eq!(Type { width: 1, signed: true }.literal(1), "1'sh1");
    }

    #[test]
    fn values_must_fit() {
        assert_eq!(Type::bits(64).pattern(u64::MAX.into()), Some(u64::MAX));
        assert_eq!(Type { width: 8, signed: true }.pattern(-128), Some(0x80));
        assert_eq!(Type { width: 8, signed: true }.pattern(128), None);
        assert_eq!(Type::bits(8).pattern(256), None);
        assert_eq!(Type::bits(8).pattern(-1), None);
    }

    #[test]
    fn masks_never_overflow() {
        assert_eq!(mask(0, 64), u64::MAX);
        assert_eq!(mask(4, 4), 0xf0);
        assert_eq!(mask(64, 1), 0);
    }
}
