//! The wave: an angle that turns once per period, the bits of the PRBS, and their scaling.

use super::ports::{ExcitationKind, Inputs};

/// Fraction bits of the frequency, whose unit is the first frequency.
pub const FREQUENCY_FRACTION: u32 = 16;
/// Width of the frequency in bits: it stays below 64 times the first.
pub const FREQUENCY_BITS: u32 = 22;
/// Steps of a turn of the angle.
pub const TURN_STEPS: u32 = 256;
/// Number of bits of the PRBS's shift register, x^15 + x^14 + 1.
pub const PRBS_BITS: u32 = 15;

/// First frequency of a chirp, and the frequency of all other kinds.
const FIRST_FREQUENCY: u32 = 1 << FREQUENCY_FRACTION;
/// Fraction bits of the amount by which the angle is behind; a tick adds 256 times the frequency to it.
const AHEAD_FRACTION: u32 = 4;
/// Width of that amount in bits.
const AHEAD_BITS: u32 = 21;
/// Clocks to scale a value; the last eight are for the bits of the triangle.
pub(super) const SCALE_CLOCKS: u8 = 16;

/// The wave's registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Wave {
    /// Angle in 256ths of a turn.
    angle: u8,
    /// Amount by which the angle is behind: periods of 256 steps each, Q17.4.
    ahead: u32,
    frequency: u32,
    /// Whether the angle has passed a whole turn in this tick.
    turned: bool,
    /// Shift register of the PRBS with every bit inverted: its seed, all ones, is 0 here.
    noise: u16,
}

impl Default for Wave {
    fn default() -> Self {
        Self {
            angle: 0,
            ahead: 0,
            frequency: FIRST_FREQUENCY,
            turned: false,
            noise: 0,
        }
    }
}

/// The wave is too fast to continue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TooFast;

impl Wave {
    /// Begins a tick.
    pub(super) fn advance(&mut self, inputs: &Inputs) -> Result<(), TooFast> {
        self.ahead += self.frequency >> (FREQUENCY_FRACTION - 8 - AHEAD_FRACTION);
        self.ahead &= (1 << AHEAD_BITS) - 1;
        self.turned = false;
        self.frequency += u32::from(inputs.sweep);
        let overflows = self.frequency >> FREQUENCY_BITS != 0;
        self.frequency &= (1 << FREQUENCY_BITS) - 1;
        if inputs.kind == ExcitationKind::Chirp && overflows {
            Err(TooFast)
        } else {
            Ok(())
        }
    }

    /// Resets the frequency in every clock, except that of a chirp.
    pub(super) fn keep_frequency(&mut self, kind: ExcitationKind) {
        if kind != ExcitationKind::Chirp {
            self.frequency = FIRST_FREQUENCY;
        }
    }

    /// Turns the angle by one step if it is behind by at least one.
    pub(super) fn turn(&mut self, period_ticks: u16) -> Result<bool, TooFast> {
        let Some(rest) = self.ahead.checked_sub(u32::from(period_ticks) << AHEAD_FRACTION) else {
            return Ok(false);
        };
        self.ahead = rest;
        self.angle = self.angle.wrapping_add(1);
        if self.angle > 0 {
            return Ok(true);
        }
        let feedback = !(self.noise >> 14 ^ self.noise >> 13) & 1;
        self.noise = (self.noise << 1 | feedback) & ((1 << PRBS_BITS) - 1);
        let turned_twice = self.turned;
        self.turned = true;
        if turned_twice { Err(TooFast) } else { Ok(true) }
    }

    fn is_negative(&self, kind: ExcitationKind) -> bool {
        match kind {
            ExcitationKind::Prbs => self.noise >> (PRBS_BITS - 1) & 1 != 0,
            _ => self.angle & 0x80 != 0,
        }
    }

    /// One of the scaling clocks: halves the sum of `value` and plus or minus the amplitude, or of `value` alone,
    /// rounded away from 0.
    ///
    /// The bits of the fraction come lowest first. For a square they are all ones, so that after 16 clocks the value
    /// is exactly the amplitude.
    pub(super) fn scale(&self, value: i32, clock: u8, inputs: &Inputs) -> i32 {
        let quarter = self.angle & 0x3f ^ if self.angle & 0x40 != 0 { 0x3f } else { 0 };
        // Half a step is added, so that the steps around 0 are equal to the others.
        let bits = u16::from(quarter) << 10 | 1 << 9;
        let adds = inputs.kind != ExcitationKind::Chirp || bits >> clock & 1 != 0;
        let amplitude = i32::from(inputs.amplitude.min(inputs.amplitude_limit));
        let addend = if adds { amplitude } else { 0 };
        if self.is_negative(inputs.kind) {
            (value - addend) >> 1
        } else {
            (value + addend + 1) >> 1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(wave: &Wave, inputs: &Inputs) -> i32 {
        (0..SCALE_CLOCKS).fold(0, |value, clock| wave.scale(value, clock, inputs))
    }

    #[test]
    fn a_square_is_exactly_the_amplitude() {
        for amplitude in [0, 1, 2, 3, 255, 256, 0x7fff, 0x8000, 0xffff] {
            let inputs = Inputs {
                kind: ExcitationKind::Square,
                amplitude,
                amplitude_limit: u16::MAX,
                ..Inputs::default()
            };
            for (angle, sign) in [(0, 1), (127, 1), (128, -1), (255, -1)] {
                let wave = Wave {
                    angle,
                    ..Wave::default()
                };
                assert_eq!(value(&wave, &inputs), sign * i32::from(amplitude));
            }
        }
    }

    #[test]
    fn the_triangle_is_straight_and_odd() {
        // With 64 · 256 every step is 256, and half of that at the ends.
        let inputs = Inputs {
            kind: ExcitationKind::Chirp,
            amplitude: u16::MAX,
            amplitude_limit: 64 << 8,
            ..Inputs::default()
        };
        let at = |angle| {
            value(
                &Wave {
                    angle,
                    ..Wave::default()
                },
                &inputs,
            )
        };
        for angle in 0..=255u8 {
            let place = i32::from(angle);
            let expected = match angle / 64 {
                0 => 256 * place + 128,
                1 | 2 => 256 * (127 - place) + 128,
                _ => 256 * (place - 256) + 128,
            };
            assert_eq!(at(angle), expected, "angle {angle}");
            assert_eq!(at(angle), -at(angle.wrapping_add(128)));
        }
    }

    #[test]
    fn the_prbs_is_that_of_its_polynomial() {
        // s(n) = s(n − 15) + s(n − 14) modulo 2, from fifteen ones; ITU-T O.150 has this polynomial.
        let mut reference = vec![true; 15];
        while reference.len() < 32_767 + 15 {
            let n = reference.len();
            reference.push(reference[n - 15] ^ reference[n - 14]);
        }
        let mut wave = Wave {
            angle: 255,
            ..Wave::default()
        };
        for (n, one) in reference.iter().enumerate() {
            assert_eq!(!wave.is_negative(ExcitationKind::Prbs), *one, "bit {n}");
            wave.turned = false;
            wave.angle = 255;
            assert_eq!(wave.turn(0), Ok(true));
        }
        assert_eq!(reference[..15], reference[32_767..]);
        assert_eq!(reference[..32_767].iter().filter(|one| **one).count(), 16_384);
        // The start of the sequence, by hand: 15 ones, 14 zeros, a one.
        assert!(reference[15..29].iter().all(|one| !one) && reference[29]);
    }
}
