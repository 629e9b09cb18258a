//! Posicast: hdl.
