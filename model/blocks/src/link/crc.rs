//! CRC-32 of IEEE 802.3, bit by bit, as the hardware computes it.

/// The polynomial, lowest power in the highest bit.
pub const POLYNOMIAL: u32 = 0xedb8_8320;
/// Contents of the register before the first byte.
pub const CRC_START: u32 = 0xffff_ffff;
/// Contents of the register after bytes that are followed by their own CRC.
pub const RESIDUE: u32 = 0xdebb_20e3;

/// The register of a CRC that is being computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crc(u32);

impl Default for Crc {
    fn default() -> Self {
        Self(CRC_START)
    }
}

impl Crc {
    /// The CRC of these bytes.
    pub fn of(bytes: &[u8]) -> u32 {
        let mut crc = Self::default();
        bytes.iter().for_each(|byte| crc.add(*byte));
        crc.value()
    }

    /// Adds a byte, lowest bit first.
    pub fn add(&mut self, byte: u8) {
        for bit in 0..8 {
            let feedback = (self.0 ^ u32::from(byte >> bit)) & 1 != 0;
            self.0 = (self.0 >> 1) ^ if feedback { POLYNOMIAL } else { 0 };
        }
    }

    /// The CRC of the bytes so far.
    pub fn value(self) -> u32 {
        !self.0
    }

    /// Whether the bytes so far end with the CRC of those before it.
    pub fn holds(self) -> bool {
        self.0 == RESIDUE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms (G. Cook), and values of
    /// Python's `binascii.crc32`.
    #[test]
    fn golden_values_of_others() {
        assert_eq!(Crc::of(b"123456789"), 0xcbf4_3926);
        assert_eq!(Crc::of(b""), 0);
        assert_eq!(Crc::of(&[0; 4]), 0x2144_df1c);
        assert_eq!(Crc::of(&(0..=255).collect::<Vec<u8>>()), 0x2905_8c73);
    }

    #[test]
    fn bytes_with_their_own_crc_leave_the_residue() {
        for length in 0..50 {
            let mut crc = Crc::default();
            let bytes: Vec<u8> = (0..length).map(|byte: u8| byte.wrapping_mul(91)).collect();
            bytes
                .iter()
                .chain(&Crc::of(&bytes).to_le_bytes())
                .for_each(|byte| crc.add(*byte));
            assert!(crc.holds(), "{length} bytes");
        }
    }
}
