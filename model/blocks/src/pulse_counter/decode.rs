//! Decodes the levels of this clock and of the one before into steps.

use super::ports::Inputs;

/// Result of decoding a clock.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Event {
    pub(super) step: bool,
    pub(super) up: bool,
    pub(super) illegal: bool,
}

/// Decodes a clock; `levels` and `before` are A and B.
pub(super) fn decode(inputs: &Inputs, levels: [bool; 2], before: [bool; 2]) -> Event {
    let ordered = |[a, b]: [bool; 2]| if inputs.swap { [b, a] } else { [a, b] };
    let ([a, b], [a_before, b_before]) = (ordered(levels), ordered(before));
    let (edge_a, edge_b) = (a != a_before, b != b_before);
    let (rise_a, rise_b) = (a && edge_a, b && edge_b);
    let quadrature = |step| Event {
        step,
        up: a != b_before,
        illegal: edge_a && edge_b,
    };
    let mut event = match inputs.mode & 7 {
        0 => quadrature(edge_a != edge_b),
        1 => quadrature(edge_a && !edge_b),
        2 => quadrature(edge_a && !edge_b && !b),
        3 => Event {
            step: rise_a,
            up: b,
            illegal: false,
        },
        4 => Event {
            step: rise_a != rise_b,
            up: rise_a,
            illegal: false,
        },
        _ => Event::default(),
    };
    event.up ^= inputs.invert;
    event
}
