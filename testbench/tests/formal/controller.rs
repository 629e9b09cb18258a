//! Proofs of the controller and its arithmetic.

use crate::formal::fails;

#[test]
fn formal_a_sum_that_goes_on_from_the_last_one_is_found() {
    let first = "begins_sum = (sequencer_step == OF_REFERENCE)";
    fails(
        "sliding_mode",
        first,
        &first.replace("OF_REFERENCE", "COULOMB"),
        "begins_anew",
    );
}

#[test]
fn formal_a_shift_that_loses_the_sign_is_found() {
    fails(
        "scaled_product",
        "by_one = $signed(shifter[50:1])",
        "by_one = $signed({1'b0, shifter[49:1]})",
        "half_up",
    );
}

#[test]
fn formal_a_product_that_is_cut_instead_of_rounded_is_found() {
    fails("accumulator", "HALF = 53'd1", "HALF = 53'd0", "exact_sum");
}

#[test]
fn formal_a_limit_that_is_passed_by_an_lsb_is_found() {
    fails("limiter", "borrow = 33'd1", "borrow = 33'd0", "known_over");
}
