//! Fewer impulses, where a firmware takes only a few of them.

use crate::impulse::Impulse;

/// Impulses of a shaper with those merged that a firmware would not take: amplitudes below `least_amplitude` always, and neighbours up to `apart_s` apart
/// while there are more than `most`. Two impulses become one of their sum at their weighted mean time, which changes a mode's pole sum by about
/// `A·(ω·apart)²/8`. The result may still have more than `most`.
pub fn merged(impulses: &[Impulse], most: usize, least_amplitude: f64, apart_s: f64) -> Vec<Impulse> {
    let mut left = impulses.to_vec();
    while let Some(small) = left
        .iter()
        .position(|impulse| impulse.amplitude.abs() < least_amplitude)
        .filter(|_| left.len() > 1)
    {
        let gap_before = small
            .checked_sub(1)
            .map(|before| left[small].time_s - left[before].time_s);
        let gap_after = left.get(small + 1).map(|after| after.time_s - left[small].time_s);
        let first = match (gap_before, gap_after) {
            (Some(before), Some(after)) if before <= after => small - 1,
            (Some(_), None) => small - 1,
            _ => small,
        };
        join(&mut left, first);
    }
    while left.len() > most {
        let near = |pair: &[Impulse]| {
            pair[1].time_s - pair[0].time_s <= apart_s && pair[0].amplitude * pair[1].amplitude > 0.0
        };
        match left.windows(2).position(near) {
            Some(first) => join(&mut left, first),
            None => break,
        }
    }
    left
}

/// Joins an impulse with the next one.
fn join(impulses: &mut Vec<Impulse>, first: usize) {
    let next = impulses.remove(first + 1);
    let impulse = &mut impulses[first];
    let amplitude = impulse.amplitude + next.amplitude;
    let share = next.amplitude / amplitude;
    // Of two signs, the larger one keeps its place.
    impulse.time_s = match impulse.amplitude * next.amplitude > 0.0 {
        true => impulse.time_s + share * (next.time_s - impulse.time_s),
        false if next.amplitude.abs() > impulse.amplitude.abs() => next.time_s,
        false => impulse.time_s,
    };
    impulse.amplitude = amplitude;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::residual_vibration;
    use crate::mode::Mode;

    #[test]
    fn pairs_of_taps_become_impulses_that_leave_as_little() {
        let taps = [
            (0.0, 0.2997),
            (0.0095, 0.2),
            (0.0096, 0.2),
            (0.019, 0.0003),
            (0.0191, 0.3),
        ];
        let taps = taps.map(|(time_s, amplitude)| Impulse { time_s, amplitude });
        let few = merged(&taps, 3, 0.001, 1.01e-4);
        assert_eq!(few.len(), 3);
        assert!((few.iter().map(|impulse| impulse.amplitude).sum::<f64>() - 1.0).abs() < 1e-12);
        for frequency_hz in [45.0, 52.4, 60.0] {
            let mode = Mode {
                frequency_hz,
                damping: 0.02,
            };
            let change = residual_vibration(&taps, &mode) - residual_vibration(&few, &mode);
            assert!(change.abs() < 2e-4, "{change}");
        }
        // Impulses that are far apart or differ in sign are never merged.
        let signs = [(0.0, 1.0), (0.0001, -1.0), (0.01, 1.0)].map(|(time_s, amplitude)| Impulse { time_s, amplitude });
        assert_eq!(merged(&signs, 2, 0.001, 1e-3).len(), 3);
    }
}
