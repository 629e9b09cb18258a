//! Entries of the command FIFO, as the words that a host writes.
//!
//! | word | segment | point |
//! |---|---|---|
//! | 0 | jerk, lower 32 of 40 bits (Q8.32 counts per tick³) | position, Q24.8 counts |
//! | 1 | jerk, upper 8 bits, sign extended to 32 | velocity, Q16.16 counts per tick |
//! | 2 | not used, need not be written | acceleration, Q8.24 counts per tick² |
//! | 3 | ticks, and flags; its write commits the entry | the same |

use crate::rtl::shaper::wrap;

/// Words of an entry.
pub const ENTRY_WORDS: usize = 4;
/// Width of the ticks of an entry.
pub const TICK_BITS: u32 = 24;
/// Width of jerk and acceleration: Q8.32.
pub const ACCELERATION_BITS: u32 = 40;
/// Flag in word 3: the entry is a point.
pub const POINT: u32 = 1 << 31;
/// Flag in word 3: `notify` is high for a clock when the entry has ended.
pub const NOTIFY: u32 = 1 << 30;
/// Bits of word 3 that must be 0.
pub const RESERVED: u32 = !(POINT | NOTIFY | ((1 << TICK_BITS) - 1));

/// Motion that an entry commands during its ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntryMotion {
    /// A constant jerk, Q8.32 counts per tick³, 40 bits.
    Jerk(i64),
    /// A state, taken at once and held.
    Point(Point),
}

/// A state of the command, in its words.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Point {
    /// Position in Q24.8 counts.
    pub position: i32,
    /// Velocity in Q16.16 counts per tick.
    pub velocity: i32,
    /// Acceleration in Q8.24 counts per tick².
    pub acceleration: i32,
}

/// An entry of the command FIFO.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Duration in ticks, 1 to 2^24 − 1.
    pub ticks: u32,
    /// Motion of the segment or point.
    pub motion: EntryMotion,
    /// Whether the host is told when the entry has ended.
    pub notify: bool,
}

impl Entry {
    /// The words, in the order in which a host writes them.
    pub fn words(&self) -> [u32; ENTRY_WORDS] {
        let notify = if self.notify { NOTIFY } else { 0 };
        match self.motion {
            EntryMotion::Jerk(jerk) => [jerk as u32, (jerk >> 32) as u32, 0, self.ticks | notify],
            EntryMotion::Point(point) => [
                point.position as u32,
                point.velocity as u32,
                point.acceleration as u32,
                self.ticks | notify | POINT,
            ],
        }
    }

    /// Decodes words as the hardware does, which uses only the lower 40 bits of a jerk.
    pub(super) fn from_words(words: &[u32; ENTRY_WORDS]) -> Self {
        let [first, second, third, last] = *words;
        let motion = if last & POINT != 0 {
            EntryMotion::Point(Point {
                position: first as i32,
                velocity: second as i32,
                acceleration: third as i32,
            })
        } else {
            let jerk = u64::from(first) | u64::from(second) << 32;
            EntryMotion::Jerk(wrap(jerk as i64, ACCELERATION_BITS))
        };
        Self {
            ticks: last & ((1 << TICK_BITS) - 1),
            motion,
            notify: last & NOTIFY != 0,
        }
    }
}

/// Whether word 1 of a segment holds more than the upper 8 bits of a 40-bit jerk.
pub(super) fn too_wide(word: u32) -> bool {
    let upper = (word as i32) >> 7;
    upper != 0 && upper != -1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_words_and_back() {
        let point = EntryMotion::Point(Point {
            position: -1,
            velocity: i32::MAX,
            acceleration: i32::MIN,
        });
        for motion in [
            EntryMotion::Jerk(-1),
            EntryMotion::Jerk((1 << 39) - 1),
            EntryMotion::Jerk(-(1 << 39)),
            point,
        ] {
            for notify in [false, true] {
                let entry = Entry {
                    ticks: 0xff_ffff,
                    motion,
                    notify,
                };
                let words = entry.words();
                assert_eq!(Entry::from_words(&words), entry);
                assert_eq!(words[3] & RESERVED, 0);
                assert!(matches!(motion, EntryMotion::Point(_)) || !too_wide(words[1]));
            }
        }
        assert!(too_wide(0x80) && too_wide(0xffff_ff7f) && !too_wide(0x7f) && !too_wide(0xffff_ff80));
    }
}
