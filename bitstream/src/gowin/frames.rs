//! A bitstream file of Gowin (`.fs`): comments, commands, frames of bits with their checksums, and the sum of all, as digits in lines.
//!
//! ```text
//! //comment
//! command           the last one before the frames has their number
//! frame             padding, the bits from the last column to the first, CRC-16, six bytes FF
//! ...               as many frames as the device has rows of bits, then those with the contents of block RAMs
//! command           among them the sum of the bits of the device's rows
//! ```

use crate::BitstreamError;
use crate::toolchain::TextBit;

/// Name of the program that writes the file, for errors.
const TOOL: &str = "gowin_pack";
/// Beginning of a comment.
const COMMENT: &str = "//";
/// Commands before the first one that the checksum of the first frame covers.
const PREAMBLE: usize = 3;
/// Command with the number of frames.
const FRAMES: u8 = 0x3B;
/// Command with an address in the flash, which no checksum covers.
const FLASH_ADDRESS: u8 = 0xD2;
/// Command with the sum of the device's bits.
const SUM: u8 = 0x0A;
/// Digits of a byte.
const BYTE: usize = 8;
/// Digits behind the bits of a frame: its checksum, and six bytes.
const FRAME_END: usize = 64;
/// Bytes behind the checksum of a frame.
const FILL: [u8; 6] = [0xFF; 6];

/// A bitstream file whose form has been checked.
#[derive(Debug, Clone)]
pub struct GowinFrames {
    lines: Vec<String>,
    /// Index of the line with the first frame.
    first: usize,
    /// Number of frames.
    count: usize,
    /// Rows and columns of the device's bits.
    size: (usize, usize),
}

impl GowinFrames {
    /// Reads a file of a device with this many rows and columns of bits.
    ///
    /// # Errors
    /// [`BitstreamError::Unreadable`] for another form, such as a compressed file or one of another device.
    pub fn read(text: &str, size: (usize, usize)) -> Result<Self, BitstreamError> {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for (number, line) in lines.iter().enumerate().filter(|(_, line)| !is_comment(line)) {
            if line.is_empty() || line.len() % BYTE != 0 || line.bytes().any(|digit| digit != b'0' && digit != b'1') {
                return Err(unreadable(format!("line {}: no bytes of binary digits", number + 1)));
            }
        }
        let is_last = |line: &String| !is_comment(line) && byte(line, 0) == FRAMES;
        let number = lines.iter().position(is_last);
        let number = number.ok_or_else(|| unreadable("no command with the number of frames".to_owned()))?;
        let count = usize::from_str_radix(&lines[number][2 * BYTE..], 2).unwrap_or_default();
        let first = number + 1;
        let length = size.1.div_ceil(BYTE) * BYTE + FRAME_END;
        let frames = lines.get(first..first + count);
        let are_whole = frames.is_some_and(|frames| frames.iter().all(|frame| frame.len() == length));
        if count < size.0 || !are_whole {
            return Err(unreadable(format!(
                "{count} frames, of which this device has at least {} of {length} digits",
                size.0
            )));
        }
        let frames = Self {
            lines,
            first,
            count,
            size,
        };
        frames.sum_line().map(|_| frames)
    }

    /// Number of frames with contents of block RAMs.
    #[must_use]
    pub fn memory_frames(&self) -> usize {
        self.count - self.size.0
    }

    /// Whether the bit of a row and a column of the device is set; rows past the device's are those of memories.
    #[must_use]
    pub fn bit(&self, row: usize, column: usize) -> bool {
        let place = self.place(row, column);
        self.lines[place.line].as_bytes()[place.column] == b'1'
    }

    /// The digit of a bit.
    #[must_use]
    pub fn place(&self, row: usize, column: usize) -> TextBit {
        let line = self.first + row;
        TextBit {
            line,
            column: self.lines[line].len() - FRAME_END - 1 - column,
            bit: 0,
        }
    }

    /// The row and column of a digit.
    #[must_use]
    pub fn row_and_column(&self, place: TextBit) -> (usize, usize) {
        let end = self.lines[place.line].len() - FRAME_END - 1;
        (place.line - self.first, end - place.column)
    }

    /// The file with these bits flipped. Its checksums stay as they were.
    #[must_use]
    pub fn flipped(&self, places: &[TextBit]) -> String {
        let mut lines = self.lines.clone();
        for place in places {
            let line = &mut lines[place.line];
            let digit = if line.as_bytes()[place.column] == b'1' {
                "0"
            } else {
                "1"
            };
            line.replace_range(place.column..=place.column, digit);
        }
        joined(&lines)
    }

    /// The file with the right checksums.
    ///
    /// # Errors
    /// [`BitstreamError::Unreadable`] if it has no sum.
    pub fn with_checksums(&self) -> Result<String, BitstreamError> {
        let mut lines = self.lines.clone();
        for (frame, checksum) in self.checksums().into_iter().enumerate() {
            let line = &mut lines[self.first + frame];
            let start = line.len() - FRAME_END;
            let digits = format!("{:08b}{:08b}", checksum & 0xFF, checksum >> 8);
            line.replace_range(start..start + digits.len(), &digits);
        }
        let sum = self.sum_line()?;
        lines[sum] = self.sum_command();
        Ok(joined(&lines))
    }

    /// Compares all checksums with those of the bits.
    ///
    /// # Errors
    /// [`BitstreamError::Unreadable`] with the first that is wrong.
    pub fn check(&self) -> Result<(), BitstreamError> {
        for (frame, checksum) in self.checksums().into_iter().enumerate() {
            let line = &self.lines[self.first + frame];
            let end = (line.len() - FRAME_END) / BYTE;
            let found = u16::from(byte(line, end + 1)) << 8 | u16::from(byte(line, end));
            if found != checksum {
                return Err(unreadable(format!(
                    "frame {}: its checksum is {found:04x}, that of its bits {checksum:04x}",
                    frame + 1
                )));
            }
        }
        if self.lines[self.sum_line()?] != self.sum_command() {
            return Err(unreadable("the sum of the bits is wrong".to_owned()));
        }
        Ok(())
    }

    /// The checksum of each frame: of its bits with what comes before them, the commands or the end of the frame before.
    fn checksums(&self) -> Vec<u16> {
        let commands = self.lines[..self.first].iter().filter(|line| !is_comment(line));
        let commands = commands.skip(PREAMBLE).filter(|line| byte(line, 0) != FLASH_ADDRESS);
        let mut before: Vec<u8> = commands.flat_map(|line| bytes(line)).collect();
        let frames = self.lines[self.first..self.first + self.count].iter();
        let checksums = frames.map(|line| {
            let mut covered = std::mem::replace(&mut before, FILL.to_vec());
            covered.extend(bytes(&line[..line.len() - FRAME_END]));
            crc16(&covered)
        });
        checksums.collect()
    }

    fn sum_line(&self) -> Result<usize, BitstreamError> {
        let after = self.first + self.count;
        let rest = self.lines[after..].iter();
        let at = rest
            .clone()
            .position(|line| !is_comment(line) && byte(line, 0) == SUM && line.len() == 8 * BYTE);
        at.map(|index| after + index)
            .ok_or_else(|| unreadable("no command with the sum of the bits".to_owned()))
    }

    /// The command with the sum of the device's bits, without those of memories and padding, as numbers of 16 bits.
    fn sum_command(&self) -> String {
        let (rows, columns) = self.size;
        let frames = self.lines[self.first..self.first + rows].iter();
        let digits: Vec<u8> = frames
            .flat_map(|line| {
                let end = line.len() - FRAME_END;
                line.as_bytes()[end - columns..end].iter().copied()
            })
            .collect();
        let words = digits.chunks(2 * BYTE).map(|word| {
            let value = word
                .iter()
                .fold(0u32, |value, digit| value << 1 | u32::from(*digit == b'1'));
            value << (2 * BYTE - word.len())
        });
        let sum = words.fold(0u16, |sum, word| sum.wrapping_add(word as u16));
        format!("{:064b}", u64::from(SUM) << 56 | u64::from(sum))
    }
}

fn is_comment(line: &str) -> bool {
    line.starts_with(COMMENT)
}

/// A byte of a line of binary digits; 0 past its end.
fn byte(line: &str, index: usize) -> u8 {
    let digits = line.as_bytes().iter().skip(index * BYTE).take(BYTE);
    digits.fold(0, |value, digit| value << 1 | u8::from(*digit == b'1'))
}

fn bytes(line: &str) -> impl Iterator<Item = u8> + '_ {
    let bytes = line.as_bytes().chunks(BYTE);
    bytes.map(|digits| {
        digits
            .iter()
            .fold(0, |value, digit| value << 1 | u8::from(*digit == b'1'))
    })
}

fn joined(lines: &[String]) -> String {
    lines.iter().flat_map(|line| [line.as_str(), "\n"]).collect()
}

/// The CRC-16 with the polynomial 8005, lowest bit first, start value 0.
fn crc16(bytes: &[u8]) -> u16 {
    const REVERSED: u16 = 0xA001;
    bytes.iter().fold(0, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte), |crc, _| match crc & 1 {
            0 => crc >> 1,
            _ => crc >> 1 ^ REVERSED,
        })
    })
}

fn unreadable(reason: String) -> BitstreamError {
    BitstreamError::Unreadable { tool: TOOL, reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_its_catalogue() {
        // The check value of CRC-16/ARC.
        assert_eq!(crc16(b"123456789"), 0xBB3D);
    }

    /// Two rows of ten bits, and a frame of a memory.
    fn file() -> String {
        let command = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:08b}")).collect::<String>();
        let frame = |bits: &str| format!("111111{bits}{}", "1".repeat(FRAME_END));
        let lines = [
            "//posicast bits a b c".to_owned(),
            command(&[0xFF; 20]),
            command(&[0xFF; 2]),
            command(&[0xA5, 0xC3]),
            command(&[0x06, 0, 0, 0, 0x11, 0, 0x48, 0x1B]),
            command(&[FLASH_ADDRESS, 0, 0xFF, 0xFF, 0, 0xFF, 0xF0, 0]),
            command(&[FRAMES, 0x80, 0, 3]),
            frame("0000000001"),
            frame("1000000000"),
            frame("0101010101"),
            command(&[0xFF; 18]),
            command(&[SUM, 0, 0, 0, 0, 0, 0, 0]),
        ];
        joined(&lines)
    }

    #[test]
    fn bits_are_found_flipped_and_covered_by_their_checksums() {
        let frames = GowinFrames::read(&file(), (2, 10)).unwrap();
        assert!(frames.check().is_err());
        let packed = frames.with_checksums().unwrap();
        let frames = GowinFrames::read(&packed, (2, 10)).unwrap();
        frames.check().unwrap();
        let set: Vec<_> = (0..2)
            .flat_map(|row| (0..10).map(move |column| (row, column)))
            .filter(|(row, column)| frames.bit(*row, *column))
            .collect();
        assert_eq!((set, frames.memory_frames()), (vec![(0, 0), (1, 9)], 1));
        let place = frames.place(1, 3);
        assert_eq!(frames.row_and_column(place), (1, 3));
        let flipped = GowinFrames::read(&frames.flipped(&[place]), (2, 10)).unwrap();
        assert!(flipped.bit(1, 3));
        let message = flipped.check().unwrap_err().to_string();
        assert!(message.contains("frame 2"), "{message}");
        // The bits are 0000000001 1000000000: as numbers of 16 bits, 0060 and 0000.
        assert!(
            packed.contains(&format!("{:064b}", 0x0A00_0000_0000_0060u64)),
            "{packed}"
        );
    }

    #[test]
    fn files_of_another_form_are_refused() {
        for (from, to) in [
            ("//posicast bits a b c\n", "a comment without slashes\n"),
            ("0011101110000000", "0011110010000000"),
            ("0000101000000000", "0000101100000000"),
        ] {
            let text = file();
            assert!(text.contains(from), "{from}");
            assert!(GowinFrames::read(&text.replace(from, to), (2, 10)).is_err(), "{from}");
        }
        assert!(GowinFrames::read(&file(), (4, 10)).is_err());
        assert!(GowinFrames::read(&file(), (2, 20)).is_err());
    }
}
