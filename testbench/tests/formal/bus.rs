//! Proofs of the blocks that the bus writes: registers, commits, settings.

use crate::formal::{fails, is_no_longer_proven};

#[test]
fn formal_a_law_that_changes_in_a_pass_is_found() {
    is_no_longer_proven("law_and_bank", "applies = waits && ends", "applies = waits");
}

#[test]
fn formal_a_byte_that_nobody_wrote_is_found() {
    fails(
        "registers",
        "phase[15:8] <= avs_writedata[15:8]",
        "phase[15:8] <= avs_writedata[7:0]",
        "holds_what_was_written",
    );
}

#[test]
fn formal_a_write_after_its_commit_is_found() {
    fails(
        "commit",
        "if (write_law && !waits && avs_byteenable[0])",
        "if (write_law && avs_byteenable[0])",
        "all_at_once",
    );
}

#[test]
fn formal_a_setting_that_changes_in_use_is_found() {
    fails("setting_banks", " & (setting_bank != bank)", "", "active_stays");
}

#[test]
fn formal_a_read_back_in_a_pass_is_found() {
    fails("setting_banks", "& !busy", "", "serves_idle");
}

#[test]
fn formal_a_read_more_than_the_queues_hold_is_found() {
    is_no_longer_proven("axi_lite_bridge", "& !open_reads[2]", "");
}

#[test]
fn formal_a_write_that_goes_before_its_word_is_found() {
    fails(
        "axi_lite_bridge",
        "write_addresses_holds & write_words_holds",
        "write_addresses_holds",
        "",
    );
}

#[test]
fn formal_reads_that_let_no_write_pass_are_found() {
    fails(
        "axi_lite_bridge",
        "read_first_next = writes",
        "read_first_next = 1'd1",
        "",
    );
}

#[test]
fn formal_a_classic_request_that_is_made_again_is_found() {
    fails("wishbone_bridge", "pipelined | !open", "1'd1", "");
}

#[test]
fn formal_an_answer_to_a_master_that_has_left_is_found() {
    fails(
        "wishbone_bridge",
        "passed & !failed & listens",
        "passed & !failed",
        "answer",
    );
}
