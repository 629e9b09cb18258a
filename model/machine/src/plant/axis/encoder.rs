//! The encoder: turns a position into edges of A, B and index.
//!
//! A count is 1/counts_per_unit long, from half a count below its number to half above. In the cell of the time grid
//! after a new position the encoder moves there in a straight line. An edge comes in the clock in which this line
//! crosses to another count, at the earliest a clock after the edge before it. Edges of a faster motion come late,
//! but none is lost.
//!
//! ```text
//! count   …  0   1   2   3   0  …       up: A leads B
//! a       ___/‾‾‾‾‾‾‾\_______
//! b       _______/‾‾‾‾‾‾‾\___
//! ```

/// Levels of an encoder's lines.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct EncoderPins {
    /// Line A.
    pub a: bool,
    /// Line B.
    pub b: bool,
    /// Index, high for one count, or the line of a probe; always low without either.
    pub z: bool,
}

/// A contact that is closed from a count on, and its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Contact {
    /// First count at which it touches.
    pub(super) at: i64,
    /// Whether it is closed at lower counts; otherwise at higher ones.
    pub(super) below: bool,
    /// Whether its line, Z, is low while it touches.
    pub(super) active_low: bool,
}

impl Contact {
    fn line(self, count: i64) -> bool {
        let touches = if self.below { count <= self.at } else { count >= self.at };
        touches != self.active_low
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Encoder {
    counts_per_unit: f64,
    cell_clocks: u32,
    index_at: Option<i64>,
    contact: Option<Contact>,
    /// Whether A and B are exchanged, so that the lines count down where the count goes up.
    reversed: bool,
    /// The count that the lines show.
    shown: i64,
    /// Start and end of the motion in the cell, in counts.
    from: f64,
    to: f64,
    /// Clocks from the start of the cell to the next edge; beyond the cell if it has none.
    next_edge: u32,
}

impl Encoder {
    pub(super) fn new(counts_per_unit: f64, cell_clocks: u32, index_at: Option<i64>, position: f64) -> Self {
        let at = position * counts_per_unit;
        Self {
            counts_per_unit,
            cell_clocks,
            index_at,
            contact: None,
            reversed: false,
            shown: nearest(at),
            from: at,
            to: at,
            next_edge: u32::MAX,
        }
    }

    /// Exchanges A and B, as the wiring may do.
    pub(super) fn reversed(self, reversed: bool) -> Self {
        Self { reversed, ..self }
    }

    /// Puts a contact on line Z, in place of the index.
    pub(super) fn with_contact(self, contact: Option<Contact>) -> Self {
        Self { contact, ..self }
    }

    /// Length of this many counts in m or rad.
    pub(super) fn length(&self, counts: f64) -> f64 {
        counts / self.counts_per_unit
    }

    pub(super) fn count(&self) -> i64 {
        self.shown
    }

    /// The count after so many clocks of the cell, however fast the motion.
    pub(super) fn sampled(&self, clocks: u32) -> i64 {
        let part = f64::from(clocks) / f64::from(self.cell_clocks);
        nearest(self.from + (self.to - self.from) * part)
    }

    pub(super) fn pins(&self) -> EncoderPins {
        let lines = ((self.shown + 1) & 2 != 0, self.shown & 2 != 0);
        let (a, b) = if self.reversed { (lines.1, lines.0) } else { lines };
        EncoderPins {
            a,
            b,
            z: match self.contact {
                Some(contact) => contact.line(self.shown),
                None => self.index_at == Some(self.shown),
            },
        }
    }

    /// Clocks from the start of the cell for which the lines are known not to change.
    #[inline]
    pub(super) fn quiet_until(&self) -> u32 {
        // The first edge of the next cell comes after its first clock.
        self.next_edge.min(self.cell_clocks + 1)
    }

    /// Begins a cell, at whose end this position is reached.
    pub(super) fn move_to(&mut self, position: f64) {
        self.from = self.to;
        self.to = position * self.counts_per_unit;
        self.plan(0);
    }

    /// Advances the time by this many clocks of the cell.
    #[inline]
    pub(super) fn pass(&mut self, clocks: u32) {
        while self.next_edge <= clocks {
            self.shown += if nearest(self.to) > self.shown { 1 } else { -1 };
            self.plan(self.next_edge);
        }
    }

    /// Finds the next edge, later than this many clocks.
    fn plan(&mut self, clocks: u32) {
        let goal = nearest(self.to);
        if goal == self.shown {
            self.next_edge = u32::MAX;
            return;
        }
        let border = self.shown as f64 + if goal > self.shown { 0.5 } else { -0.5 };
        let part = (border - self.from) / (self.to - self.from);
        // An edge that is late is not on the line, and comes at once.
        let clock = match part {
            0.0..=1.0 => (part * f64::from(self.cell_clocks)).ceil() as u32,
            _ => 0,
        };
        self.next_edge = clock.max(clocks + 1);
    }
}

fn nearest(counts: f64) -> i64 {
    (counts + 0.5).floor() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels(pins: EncoderPins) -> u8 {
        u8::from(pins.a) | u8::from(pins.b) << 1
    }

    /// Clocks (from 0) at whose end an edge comes, while the encoder moves to each position in a cell of 10 clocks.
    fn edges(encoder: &mut Encoder, positions: &[f64]) -> Vec<(u32, i64)> {
        let mut found = vec![];
        for (cell, position) in positions.iter().enumerate() {
            encoder.move_to(*position);
            for clock in 1..=10 {
                let (before, count) = (encoder.pins(), encoder.count());
                encoder.pass(clock);
                let changed = levels(before) ^ levels(encoder.pins());
                assert!(changed != 3, "two lines at once");
                if changed != 0 {
                    assert_eq!((encoder.count() - count).abs(), 1);
                    found.push((cell as u32 * 10 + clock - 1, encoder.count()));
                }
            }
        }
        found
    }

    #[test]
    fn edges_lie_where_the_line_crosses() {
        let mut encoder = Encoder::new(1.0, 10, Some(2), 0.0);
        // The motion crosses 0.5 and 1.5 on the way from 0 to 2, then 1.5 on the way back to 1.
        assert_eq!(edges(&mut encoder, &[2.0]), [(2, 1), (7, 2)]);
        assert!(encoder.pins().z);
        assert_eq!(edges(&mut encoder, &[2.4, 1.0]), [(16, 1)]);
        assert!(!encoder.pins().z);
        // A position exactly on the border belongs to the upper count.
        assert_eq!(edges(&mut encoder, &[0.5, 0.49]), [(10, 0)]);
    }

    #[test]
    fn edges_of_a_motion_that_is_too_fast_come_late() {
        let mut encoder = Encoder::new(1.0, 10, None, 0.0);
        let found = edges(&mut encoder, &[25.0, 25.0, 25.0, 25.0]);
        assert_eq!(found.len(), 25);
        assert!(found.windows(2).all(|pair| pair[1].0 > pair[0].0));
        assert_eq!(encoder.count(), 25);
        // The motion reverses before all edges have come.
        edges(&mut encoder, &[60.0, 30.0, 30.0]);
        assert_eq!(encoder.count(), 30);
    }

    #[test]
    fn infinite_and_nan_positions_do_not_panic() {
        let mut encoder = Encoder::new(1e12, 10, None, -1e9);
        for position in [1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0] {
            edges(&mut encoder, &[position]);
        }
    }
}
