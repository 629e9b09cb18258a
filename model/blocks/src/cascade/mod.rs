//! The cascade of half sums: `y_k[n] = y_{k−1}[n] + y_{k−1}[n − d_k]` for k = 1 … n, rounded once at the end.
//!
//! The datasheet is `docs/cascade.md`; the hardware is compared with this reference model. The `vibrationless` kind
//! needs it: 2^n impulses of weight 2^−n with n additions and no multiplication.
//!
//! | type | what it is |
//! |---|---|
//! | [`CascadeConfig`] | the build parameters of a cascade: word width, the delays, sizes of its memory |
//! | [`Cascade`] | cycle accurate at the ports, one [`Cascade::step`] per clock, from typed [`Inputs`] to typed [`Outputs`] |
//! | [`SampleCascade`] | the same results without the clocks: one [`SampleCascade::push`] per sample |
//!
//! ```text
//! clock     0   1   2   3      2n+1 2n+2 2n+3
//! strobe   ‾‾‾\__________________________________
//! x        < x>----------------------------------
//! busy     ___/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\____________
//! valid    _________________________/‾‾‾\________
//! y        ------- as before -------< y[n] ------
//! ```
//!
//! The history before the first sample since a start is the start value, so a constant command gives a constant
//! output. Each stage makes words one bit wider; nothing overflows and nothing saturates.
//!
//! ```
//! use posicast_blocks::cascade::{Cascade, CascadeConfig, Inputs, SampleCascade, pass_clocks};
//!
//! let config = CascadeConfig::new(32, vec![1, 2])?;
//!
//! // A step of 1000 comes out as four quarters, after 0, 1, 2 and 1 + 2 samples.
//! let mut fast = SampleCascade::new(&config);
//! assert_eq!([1000; 5].map(|x| fast.push(x)), [250, 500, 750, 1000, 1000]);
//!
//! // The same at the ports: the first result stands there `pass_clocks` after its strobe.
//! let mut cascade = Cascade::new(&config, 1);
//! cascade.step(&Inputs { strobe: true, x: 1000, ..Inputs::default() });
//! let waited = (1..100).find(|_| cascade.step(&Inputs::default()).valid);
//! assert_eq!(waited, Some(pass_clocks(2)));
//! assert_eq!(cascade.outputs().y, 250);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod clocked;
mod config;
mod sample;

pub use clocked::{Cascade, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};
pub use config::{
    CascadeConfig, CascadeConfigError, PASS_OVERHEAD_CLOCKS, RING_ADDRESS_BITS, STAGE_INDEX_BITS, WORD_BITS,
    pass_clocks,
};
pub use sample::SampleCascade;

/// Rounds the sum of 2^`stages` words to one word: half is added, `stages` bits are dropped (an arithmetic shift).
fn rounded(sum: i64, stages: u32) -> i64 {
    (sum + (1 << (stages - 1))) >> stages
}
