//! Computes rigorous bounds of the residual of a tap table, and of any shorter one.
//!
//! For any table, from closed forms, an optimiser or a user, its residual over a whole band of frequency and damping
//! has a rigorous upper bound here ([`residual_bound`]); and a lower bound of what every shaper of some duration leaves
//! is checked here ([`check_shorter`]). Both are plain arithmetic on the table, the bands and the weights: nothing of
//! the design is used. Rounding of floating point is included, so a bound is a bound of the exact value, on the premise
//! that `sin`, `cos` and `exp` are right to two units of the last place.

mod residual;
mod shorter;
mod together;

pub use residual::{ResidualBound, residual_bound};
pub use shorter::{CheckedBound, ShorterError, check_shorter};
pub use together::{CheckedShorter, CheckedTogether, check_delay, check_together};

/// Half the distance from 1 to the next number.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Bound of the relative error of a computed `e^(−pτ)`, in relation to its largest modulus in question: two units for
/// each of `exp`, `sin`, `cos` and their products, and the error of the argument, which is a product of six rounded
/// factors of `size = |p|τ`.
fn exponential_error(size: f64) -> f64 {
    (16.0 + 8.0 * size) * UNIT
}
