//! A digitised shaper in floating point, for a command that comes in pieces.

use super::Digitised;

/// The shaper before rounding, with the command's history.
///
/// ```text
/// y[n] = Σ a_i · x[n − d_i]
/// ```
///
/// ```
/// use posicast_shaper::digitise::{Digitised, DigitiseMethod, RealShaper, RealTap};
///
/// let half = |delay_samples| RealTap { delay_samples, weight: 0.5 };
/// let zv = Digitised { method_used: DigitiseMethod::Nearest, taps: vec![half(0), half(2)] };
/// let mut shaper = RealShaper::new(&zv, Some(0.0));
/// let mut shaped = [0.0; 3];
/// shaper.shape(&[1.0, 1.0, 1.0], &mut shaped);
/// assert_eq!(shaped, [0.5, 0.5, 1.0]);
/// ```
#[derive(Debug, Clone)]
pub struct RealShaper {
    taps: Vec<(usize, f64)>,
    /// The last samples, the oldest first; empty before the first one, if that starts it.
    history: Vec<f64>,
    reach: usize,
}

impl RealShaper {
    /// A shaper at rest: the samples before the first one have the value `start`, or without it that of the first one.
    pub fn new(digitised: &Digitised, start: Option<f64>) -> Self {
        let taps = digitised.taps.iter();
        let taps: Vec<_> = taps.map(|tap| (tap.delay_samples as usize, tap.weight)).collect();
        let reach = taps.iter().map(|(delay, _)| *delay).max().unwrap_or(0);
        Self {
            history: start.map_or_else(Vec::new, |start| vec![start; reach]),
            taps,
            reach,
        }
    }

    /// Takes the samples that follow, and writes the shaped ones to the beginning of `shaped`, which ends the piece where it is shorter.
    pub fn shape(&mut self, command: &[f64], shaped: &mut [f64]) {
        let count = command.len().min(shaped.len());
        let command = &command[..count];
        let Some(first) = command.first() else {
            return;
        };
        if self.history.len() < self.reach {
            self.history = vec![*first; self.reach];
        }
        let shaped = &mut shaped[..count];
        shaped.fill(0.0);
        for (delay, weight) in &self.taps {
            // The first samples come from the history.
            let old = (*delay).min(count);
            let past = &self.history[self.reach - delay..][..old];
            for (y, x) in shaped.iter_mut().zip(past.iter().chain(command)) {
                *y += weight * x;
            }
        }
        if count >= self.reach {
            self.history.clear();
            self.history.extend_from_slice(&command[count - self.reach..]);
        } else {
            self.history.drain(..count);
            self.history.extend_from_slice(command);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{DigitiseMethod, RealTap};
    use super::*;

    fn three() -> Digitised {
        let taps = [(0, 0.25), (3, 0.5), (7, 0.25)].map(|(delay_samples, weight)| RealTap { delay_samples, weight });
        Digitised {
            method_used: DigitiseMethod::Nearest,
            taps: taps.to_vec(),
        }
    }

    #[test]
    fn pieces_of_any_length_give_what_the_whole_gives() {
        let digitised = three();
        let command: Vec<i64> = (0..60).map(|n| (n * n * 7 + 3) % 101).collect();
        let whole = digitised.shape(&command);
        let command: Vec<f64> = command.iter().map(|x| *x as f64).collect();
        for piece in [1, 2, 3, 5, 7, 8, 20, 60] {
            let mut shaper = RealShaper::new(&digitised, None);
            let shaped = command.chunks(piece).flat_map(|x| {
                let mut shaped = vec![0.0; x.len()];
                shaper.shape(x, &mut shaped);
                shaped
            });
            assert_eq!(shaped.collect::<Vec<_>>(), whole, "{piece}");
        }
    }

    #[test]
    fn a_start_is_the_history() {
        let mut shaper = RealShaper::new(&three(), Some(8.0));
        let mut shaped = [0.0; 4];
        shaper.shape(&[0.0; 4], &mut shaped);
        assert_eq!(shaped, [6.0, 6.0, 6.0, 2.0]);
        shaper.shape(&[], &mut shaped);
        assert_eq!(shaped[3], 2.0);
    }
}
