//! The transform of a kernel's shape, in closed form.

/// Number of coefficients of `q`: it is of degree 3 at most.
pub(super) const COEFFICIENTS: usize = 4;

/// Coefficients of `q`, beginning with that of `y⁰`.
pub(super) type Shape = [f64; COEFFICIENTS];

/// Returns `M_k = ∫ x^(2k) cos θx dx` over −1 … 1, for k = 0 … 4, by parts.
pub(super) fn moments(theta: f64) -> [f64; COEFFICIENTS + 1] {
    let (sin, cos) = theta.sin_cos();
    let mut before = 0.0;
    [0.0, 1.0, 2.0, 3.0, 4.0].map(|k: f64| {
        before =
            2.0 * sin / theta + 4.0 * k * cos / (theta * theta) - 2.0 * k * (2.0 * k - 1.0) / (theta * theta) * before;
        before
    })
}

/// Returns `∫ x^(2k+1) sin θx dx` over −1 … 1, by parts from the moments of the same `θ`.
pub(super) fn sines(theta: f64, moments: &[f64; COEFFICIENTS + 1]) -> [f64; COEFFICIENTS + 1] {
    std::array::from_fn(|k| -2.0 * theta.cos() / theta + (2.0 * k as f64 + 1.0) / theta * moments[k])
}

/// Returns `∫ (1 − x²) q(x²) cos θx dx`, from the moments.
fn weighted(shape: &Shape, moments: &[f64; COEFFICIENTS + 1]) -> f64 {
    let pairs = moments.windows(2).map(|pair| pair[0] - pair[1]);
    shape.iter().zip(pairs).map(|(q, moment)| q * moment).sum()
}

/// Returns the integral of the shape, `G(0)`.
pub(super) fn whole(shape: &Shape) -> f64 {
    weighted(shape, &std::array::from_fn(|k| 2.0 / (2.0 * k as f64 + 1.0)))
}

/// Returns `G(θ)/G(0)`: what the shape leaves of an undamped mode, with its sign.
pub(super) fn response(shape: &Shape, theta: f64) -> f64 {
    weighted(shape, &moments(theta)) / whole(shape)
}

/// Returns the derivative of [`response`].
pub(super) fn slope(shape: &Shape, theta: f64) -> f64 {
    -weighted(shape, &sines(theta, &moments(theta))) / whole(shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_response_is_the_integral_of_the_shape() {
        let shape = [0.3, -0.7, 1.1, 0.4];
        let points = 20_000;
        for theta in [2.1, 4.0, 9.3] {
            let (mut whole, mut cosine, mut sine) = (0.0, 0.0, 0.0);
            for point in 0..points {
                let x = (2.0 * f64::from(point) + 1.0) / f64::from(points) - 1.0;
                let y = x * x;
                let value = (1.0 - y) * (0.3 - 0.7 * y + 1.1 * y * y + 0.4 * y * y * y);
                whole += value;
                cosine += value * (theta * x).cos();
                sine -= value * x * (theta * x).sin();
            }
            assert!((response(&shape, theta) - cosine / whole).abs() < 1e-7, "{theta}");
            assert!((slope(&shape, theta) - sine / whole).abs() < 1e-7, "{theta}");
        }
    }
}
