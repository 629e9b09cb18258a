//! Posicast: testbench.
