//! The shortest shapers against figures that others computed, what a tap budget costs, and what is refused.
#![cfg(test)]

mod amplitudes;
mod figures;
mod integers;
mod preferences;
mod refusals;
mod support;
mod together;
