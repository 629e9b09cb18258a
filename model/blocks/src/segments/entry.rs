//! Entries of the command FIFO, as the words that a host writes.
//!
//! | word | segment | point | cubic |
//! |---|---|---|---|
//! | 0 | jerk, lower 32 of 40 bits (Q8.32 counts per tick³) | position, Q24.8 counts | jerk, Q0.32 counts per tick³ |
//! | 1 | jerk, upper 8 bits, sign extended to 32 | velocity, Q16.16 counts per tick | velocity, as of a point |
//! | 2 | not used, need not be written | acceleration, Q8.24 counts per tick² | acceleration, as of a point |
//! | 3 | ticks, and flags; its write commits the entry | the same | the same |

use crate::shaper::wrap;

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
/// Flag in word 3: the entry is a cubic; never together with [`POINT`].
pub const CUBIC: u32 = 1 << 29;
/// Flag in word 3: the entry waits for the rest of its batch, which ends with the first entry without this flag.
pub const MORE: u32 = 1 << 28;
/// Bits of word 3 that must be 0.
pub const RESERVED: u32 = !(POINT | NOTIFY | CUBIC | MORE | ((1 << TICK_BITS) - 1));

/// Motion that an entry commands during its ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntryMotion {
    /// A constant jerk, Q8.32 counts per tick³, 40 bits.
    Jerk(i64),
    /// A state, taken at once and held.
    Point(Point),
    /// A path that goes on from the present position.
    Cubic(CubicEntry),
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

/// A polynomial of third order that starts at the present position of the command, so that the position never jumps. The first tick
/// takes velocity and acceleration, and moves by that velocity; each further one adds the jerk, as a segment does.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CubicEntry {
    /// Q0.32 counts per tick³.
    pub jerk: i32,
    /// Velocity of the first tick, Q16.16 counts per tick.
    pub velocity: i32,
    /// Acceleration of the first tick, Q8.24 counts per tick².
    pub acceleration: i32,
}

/// An entry of the command FIFO.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Duration in ticks, 1 to 2^24 − 1.
    pub ticks: u32,
    /// Motion of the segment or point.
    pub motion: EntryMotion,
    /// Whether the host is notified when the entry has ended.
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
            EntryMotion::Cubic(cubic) => [
                cubic.jerk as u32,
                cubic.velocity as u32,
                cubic.acceleration as u32,
                self.ticks | notify | CUBIC,
            ],
        }
    }

    /// The words of a batch: all of these entries are taken, or none.
    pub fn batch(entries: &[Self]) -> Vec<[u32; ENTRY_WORDS]> {
        let mut words: Vec<_> = entries.iter().map(Self::words).collect();
        if let Some((_, all_but_last)) = words.split_last_mut() {
            for entry in all_but_last {
                entry[ENTRY_WORDS - 1] |= MORE;
            }
        }
        words
    }

    /// Decodes the words as the hardware does, which uses the lower 40 bits of a jerk.
    pub(super) fn from_words(words: &[u32; ENTRY_WORDS]) -> Self {
        let [first, second, third, last] = *words;
        let motion = if last & POINT != 0 {
            EntryMotion::Point(Point {
                position: first as i32,
                velocity: second as i32,
                acceleration: third as i32,
            })
        } else if last & CUBIC != 0 {
            EntryMotion::Cubic(CubicEntry {
                jerk: first as i32,
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
    fn words_and_back() {
        let point = EntryMotion::Point(Point {
            position: -1,
            velocity: i32::MAX,
            acceleration: i32::MIN,
        });
        let cubic = EntryMotion::Cubic(CubicEntry {
            jerk: i32::MIN,
            velocity: -1,
            acceleration: i32::MAX,
        });
        for motion in [
            cubic,
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
                assert!(!matches!(motion, EntryMotion::Jerk(_)) || !too_wide(words[1]));
                let batch = Entry::batch(&[entry, entry]);
                assert_eq!([batch[0][3], batch[1][3]], [words[3] | MORE, words[3]]);
            }
        }
        assert!(too_wide(0x80) && too_wide(0xffff_ff7f) && !too_wide(0x7f) && !too_wide(0xffff_ff80));
    }
}
