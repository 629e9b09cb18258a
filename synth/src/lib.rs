//! Posicast: synth.
