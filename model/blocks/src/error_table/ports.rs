//! The ports of the error table.

use crate::ports;

ports! {
    error_table_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset: bank 1 is cleared, and nothing is compensated.
        rst: Bit as bool;
        /// One clock: `position_reference` is new. A pass that is running starts again.
        valid: Bit as bool;
        /// Commanded position of the axis; must not change from `valid` to `compensated_valid`.
        position_reference: Signed(32) as i32, "counts, Q24.8";
        /// Counted position of the axis; read in the clock after `valid`.
        measured: Signed(32) as i32, "counts";
        /// Tied: 1 uses the error at `measured`, 0 that at `position_reference`.
        on_measured: Bit as bool;
        /// Tied: 1 entries are in sixteenths of a count, 0 in 256ths.
        coarse: Bit as bool;
        /// Count at which the user's position is 0; read while `weight` is 0.
        origin: Signed(32) as i32, "counts";
        /// The drive is on; low: the weight is 0 from the next `valid` on.
        drive_enable: Bit as bool;
        /// The origin is known; low: the weight goes down.
        homed: Bit as bool;
        /// A host requests compensation; low: the weight goes down.
        error_enable: Bit as bool;
        /// The bank that a host selects: 0 the machine's, 1 the loaded one.
        error_select: Bit as bool;
        /// One clock: `error_entry` goes to `error_index` of bank 1.
        error_write: Bit as bool;
        /// Bank that is written or read back.
        error_bank: Bit as bool;
        /// Entry that is written or read back.
        error_index: Bits(8) as u8;
        /// Entry to write: true minus counted position.
        error_entry: Signed(18) as i32, "counts / 256, or / 16";
        /// One clock: the entry at `error_bank` and `error_index` is to be read back.
        error_read: Bit as bool;
    }

    /// The output ports: registers, or functions of registers.
    outputs Outputs {
        /// `position_reference` minus the error in use.
        compensated: Signed(32) as i32, "counts, Q24.8";
        /// One clock: `compensated` is new.
        compensated_valid: Bit as bool;
        /// The error in use: interpolated, times the weight.
        table_error: Signed(32) as i32, "counts, Q24.8";
        /// Part of the error that is compensated: 0 nothing, 1024 all of it.
        error_weight: Bits(11) as u16, "1 / 1024";
        /// The bank in use.
        error_bank_used: Bit as bool;
        /// All entries of bank 1 are loaded.
        error_complete: Bit as bool;
        /// One clock: an entry was refused.
        error_refused: Bit as bool;
        /// The entry that a host read back last; 0 if none is loaded.
        error_loaded: Signed(18) as i32, "counts / 256, or / 16";
        /// A host's read waits.
        error_read_waits: Bit as bool;
    }
}
