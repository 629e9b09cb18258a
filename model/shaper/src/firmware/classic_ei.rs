//! The amplitudes of EI shapers without damping (Singhose, Seering and Singer 1994; 1997), each multiplied by `K` per half period: what Klipper
//! computed until September 2025, and what Kalico and Marlin's fixed-time motion compute. With damping the residual at the mode falls
//! below the tolerance, and the band becomes narrower.

/// Amplitudes of an EI shaper with `humps` humps (1 to 3) and residual `tolerance`; `half_swing` is the ratio `K` of two half swings.
/// They sum to one without damping only.
pub(super) fn amplitudes(humps: usize, tolerance: f64, half_swing: f64) -> Vec<f64> {
    let v = tolerance;
    let undamped = match humps {
        1 => {
            let outer = (1.0 + v) / 4.0;
            vec![outer, (1.0 - v) / 2.0, outer]
        }
        2 => {
            let x = (v * v * ((1.0 - v * v).sqrt() + 1.0)).cbrt();
            let outer = (3.0 * x * x + 2.0 * x + 3.0 * v * v) / (16.0 * x);
            vec![outer, 0.5 - outer, 0.5 - outer, outer]
        }
        _ => {
            let outer = (1.0 + 3.0 * v + (8.0 * v * (1.0 + v)).sqrt()) / 16.0;
            let inner = (1.0 - v) / 4.0;
            vec![outer, inner, 1.0 - 2.0 * (outer + inner), inner, outer]
        }
    };
    let powers = std::iter::successors(Some(1.0), |power| Some(power * half_swing));
    undamped
        .into_iter()
        .zip(powers)
        .map(|(amplitude, power)| amplitude * power)
        .collect()
}
