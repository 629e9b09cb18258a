//! The ports of the step generator.

use crate::ports;

ports! {
    step_generator_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// High: the steps follow the position. Low: no step begins, and no line changes but to end a pulse.
        enable: Bit as bool;
        /// One clock: `position` is that of a tick.
        tick: Bit as bool;
        /// Position in steps, with the fraction bits of the build; only its changes count, modulo 2^32.
        position: Signed(32) as i32, "2^-fraction steps";
        /// Clears `too_fast` and `owed_exceeded`.
        clear_flags: Bit as bool;
    }

    /// The output ports: registers, and a function of two of them.
    outputs Outputs {
        /// Level of the line for steps, for steps up, or for quadrature A.
        a: Bit as bool;
        /// Level of the line for the direction (up is on), for steps down, or for quadrature B.
        b: Bit as bool;
        /// Steps given since the reset, up less down, modulo 2^32; it changes with the edge of the step.
        count: Signed(32) as i32, "steps";
        /// Steps demanded and not yet given, up less down; 0 while not `active`.
        owed: Signed(16) as i32, "steps";
        /// The steps follow the position.
        active: Bit as bool;
        /// Sticky: a tick demanded more steps than the largest rate gives. The axis has stopped.
        too_fast: Bit as bool;
        /// Sticky: more steps were owed than the limit of the build. The axis has stopped.
        owed_exceeded: Bit as bool;
        /// One of the two flags stands: the axis has stopped with a cause.
        tripped: Bit as bool;
    }
}
