//! The ports of the error table.

use crate::rtl::ports;

ports! {
    error_table_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset: bank 1 is forgotten, and nothing is compensated.
        rst: Bit as bool;
        /// One clock: `position_reference` is new. A pass that runs begins anew.
        valid: Bit as bool;
        /// Where the axis is to be; stands from `valid` to `compensated_valid`.
        position_reference: Signed(32) as i32, "counts, Q24.8";
        /// Where the axis is, by its counter; read in the clock after `valid`.
        measured: Signed(32) as i32, "counts";
        /// Tied: 1 the error at `measured` is taken, 0 that at `position_reference`.
        on_measured: Bit as bool;
        /// Tied: 1 entries are sixteenths of a count, 0 256ths.
        coarse: Bit as bool;
        /// Count at which the user's position is 0; read while `weight` is 0.
        origin: Signed(32) as i32, "counts";
        /// The drive is on; low: the weight is 0 from the next `valid` on.
        drive_enable: Bit as bool;
        /// The origin is known; low: the weight goes down.
        homed: Bit as bool;
        /// A host wants compensation; low: the weight goes down.
        error_enable: Bit as bool;
        /// The bank that a host wants: 0 the machine's, 1 the loaded one.
        error_select: Bit as bool;
        /// One clock: `error_entry` goes to `error_index` of bank 1.
        error_write: Bit as bool;
        /// Bank that is written or read back.
        error_bank: Bit as bool;
        /// Entry that is written or read back.
        error_index: Bits(8) as u8;
        /// What is written: true less counted position.
        error_entry: Signed(18) as i32, "counts / 256, or / 16";
        /// One clock: the entry at `error_bank` and `error_index` is to be read back.
        error_read: Bit as bool;
    }

    /// The output ports: registers, or functions of registers.
    outputs Outputs {
        /// `position_reference` less the error in force.
        compensated: Signed(32) as i32, "counts, Q24.8";
        /// One clock: `compensated` is new.
        compensated_valid: Bit as bool;
        /// The error in force: interpolated, times the weight.
        table_error: Signed(32) as i32, "counts, Q24.8";
        /// How much of the error counts: 0 nothing, 1024 all of it.
        error_weight: Bits(11) as u16, "1 / 1024";
        /// The bank in use.
        error_bank_used: Bit as bool;
        /// All entries of bank 1 are loaded.
        error_complete: Bit as bool;
        /// One clock: an entry was refused.
        error_refused: Bit as bool;
        /// The entry that a host read back last; 0 where none is loaded.
        error_loaded: Signed(18) as i32, "counts / 256, or / 16";
        /// A host's read was not served yet.
        error_read_waits: Bit as bool;
    }
}
