//! The label of a packed file: a comment that says of which machine, board and design it is.
//!
//! ```text
//! posicast bits MACHINE BOARD CHECKSUM
//! ```

/// Words before those of the label.
const MARK: &str = "posicast bits ";
/// Characters of the checksum that the label has.
const CHECKSUM_CHARS: usize = 16;

/// The label of a packed file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BitsLabel {
    /// Name of the machine.
    pub machine: String,
    /// Name of the board, with `-bare` if it has no wires.
    pub board: String,
    /// Beginning of the checksum of the Verilog, the pins and the versions of the tools.
    pub checksum: String,
}

impl BitsLabel {
    /// The label of a design with this checksum.
    #[must_use]
    pub fn new(machine: &str, board: &str, checksum: &str) -> Self {
        Self {
            machine: machine.to_owned(),
            board: board.to_owned(),
            checksum: checksum.chars().take(CHECKSUM_CHARS).collect(),
        }
    }

    /// The line among a bitstream's comments.
    #[must_use]
    pub fn line(&self) -> String {
        format!("{MARK}{} {} {}", self.machine, self.board, self.checksum)
    }

    /// The label in the text of a bitstream; `None` if it has none.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let words = text.lines().find_map(|line| Some(line.split_once(MARK)?.1.trim()))?;
        match words.split(' ').collect::<Vec<_>>()[..] {
            [machine, board, checksum] => Some(Self::new(machine, board, checksum)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_is_read_from_the_comments_of_either_family() {
        let label = BitsLabel::new("joint", "icebreaker", "0123456789abcdef0123");
        assert_eq!(label.checksum, "0123456789abcdef");
        for text in [
            format!(".comment\n{}\n.device 5k\n", label.line()),
            format!(".device x\n.comment {}\n", label.line()),
        ] {
            assert_eq!(BitsLabel::read(&text), Some(label.clone()));
        }
        assert_eq!(BitsLabel::read(".comment from next-pnr\n.device 5k\n"), None);
    }
}
