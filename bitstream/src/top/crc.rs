//! The checksum of a frame: CRC-8 with the polynomial x⁸ + x² + x + 1, start value 0, highest bit first (SMBus 3.1, section 6.4.1).

/// The polynomial without its highest power.
const POLYNOMIAL: u8 = 0x07;

/// The checksum of these bytes.
#[must_use]
pub fn checksum(bytes: impl IntoIterator<Item = u8>) -> u8 {
    bytes.into_iter().fold(0, followed_by)
}

/// The checksum of bytes with the checksum `crc`, followed by another byte.
#[must_use]
pub fn followed_by(crc: u8, byte: u8) -> u8 {
    (0..u8::BITS).fold(crc ^ byte, |crc, _| {
        let feedback = crc >> 7 == 1;
        crc << 1 ^ if feedback { POLYNOMIAL } else { 0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of CRC-8/SMBUS in the catalogue of parametrised CRC algorithms (G. Cook).
    #[test]
    fn golden_value_of_others() {
        assert_eq!(checksum(*b"123456789"), 0xF4);
        assert_eq!(checksum([]), 0);
    }
}
