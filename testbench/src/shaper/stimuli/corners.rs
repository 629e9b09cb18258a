//! Scripts for the corner cases of one shaper's sizes: adjacent values, the longest delay, sums that miss one by a
//! power of two. Random stimuli meet them too rarely.

use posicast_taps::{COEFFICIENT_MAX, COEFFICIENT_MIN};

use crate::shaper::{Action, TableLayout};
use Action::{Clear, Reset, Start, StartAlone, Strobe, StrobeExact, Swap, Tap, TapExact, Wait, WaitIdle};

/// Rings of up to this size are filled: filling a larger one takes more clocks than the case is worth.
const FILLED_RING_BITS: u32 = 9;
/// Number of clocks over which a second event is moved across a pass of one tap.
const PASS_SPAN: u32 = 18;

/// Returns the corner cases of a shaper with tables of these sizes, each with its name.
pub fn corners(tables: &TableLayout) -> Vec<(&'static str, Vec<Action>)> {
    let mut cases = vec![
        ("rounding", rounding(tables)),
        ("largest_products", largest_products(tables)),
        ("sums_beside_one", sums_beside_one(tables)),
        ("reset_empties_both_banks", reset_empties_both_banks()),
        ("start_and_strobe_across_a_pass", across_a_pass()),
    ];
    if tables.ring_address_bits <= FILLED_RING_BITS {
        cases.push(("longest_delay", longest_delay(tables)));
    }
    cases
}

/// Loads `coefficients` into a bank, at delays 0 to 3 in turn, which any ring has.
fn load(bank: u64, coefficients: &[i32]) -> Vec<Action> {
    let tap = |(index, coefficient): (u64, &i32)| TapExact(bank, index, *coefficient, index as i64 % 4);
    (0..).zip(coefficients).map(tap).collect()
}

fn started() -> Vec<Action> {
    vec![Reset(2), Start(0), WaitIdle]
}

/// Produces sums just below, at and above one half of an LSB, of both signs.
fn rounding(tables: &TableLayout) -> Vec<Action> {
    let half = 1 << (tables.coefficient_fraction - 1);
    let samples = [1, 1, 0, 0, -1, -1, 0, 0]
        .map(|word| [StrobeExact(word), WaitIdle])
        .concat();
    let mut script = started();
    for first in [half - 1, half, half + 1] {
        script.extend(load(1, &[first, 2 * half - first]));
        script.push(Swap(1));
        script.extend(&samples);
        script.extend([Swap(0), Strobe(0), WaitIdle]);
    }
    script
}

/// Multiplies the extreme coefficients by the extreme words.
fn largest_products(tables: &TableLayout) -> Vec<Action> {
    let one = 1 << tables.coefficient_fraction;
    let samples = [-256, -256, 256, 256, -256, 0].map(|x| [Strobe(x), WaitIdle]).concat();
    let mut script = started();
    for extreme in [COEFFICIENT_MIN, COEFFICIENT_MAX] {
        let mut coefficients = vec![extreme];
        coefficients.extend(split(i64::from(one - extreme)));
        script.extend(load(1, &coefficients));
        script.push(Swap(1));
        script.extend(&samples);
        script.extend([Swap(0), Strobe(0), WaitIdle]);
    }
    script
}

/// Loads tables whose sum is one plus or minus a power of two; none of them may become active.
fn sums_beside_one(tables: &TableLayout) -> Vec<Action> {
    let one = 1i64 << tables.coefficient_fraction;
    let mut script = started();
    for bit in 0..i64::BITS - 2 {
        for sum in [one + (1 << bit), one - (1 << bit)] {
            let coefficients = split(sum);
            if coefficients.is_empty() || coefficients.len() > 1 << tables.tap_index_bits {
                continue;
            }
            for bank in [1, 2] {
                script.extend(load(bank, &coefficients));
                script.extend([Swap(bank), Wait(1), Strobe(1), WaitIdle, Clear]);
            }
        }
        if split(one + (1 << bit)).len() > 1 << tables.tap_index_bits {
            break;
        }
    }
    script
}

/// Splits `sum` into as few coefficients of 18 bits as possible.
fn split(sum: i64) -> Vec<i32> {
    let mut rest = sum;
    let mut coefficients = Vec::new();
    // More coefficients than any table holds suffice to see that the table does not fit.
    while rest != 0 && coefficients.len() <= 1 << 9 {
        let part = rest.clamp(i64::from(COEFFICIENT_MIN), i64::from(COEFFICIENT_MAX));
        coefficients.push(part as i32);
        rest -= part;
    }
    coefficients
}

/// Checks that a loaded bank can be neither continued nor chosen after a reset.
fn reset_empties_both_banks() -> Vec<Action> {
    let mut script = Vec::new();
    for bank in [1, 2] {
        script.extend([
            Tap(bank, 0, 128, 0),
            Tap(bank, 1, 128, 1),
            Reset(1),
            Tap(bank, 2, 0, 2),
            Clear,
        ]);
        script.extend([Swap(bank), Wait(1), Strobe(9), WaitIdle, Clear]);
    }
    script
}

/// Gives a start, and a strobe, in every clock of a pass of one tap and in the clocks around its end.
fn across_a_pass() -> Vec<Action> {
    let mut script = started();
    script.extend([Tap(1, 0, 256, 0), Swap(1), Strobe(3), WaitIdle]);
    for clocks in 0..PASS_SPAN {
        for second in [StartAlone, Strobe(-20), Start(60)] {
            script.extend([Strobe(77), Wait(clocks), second, WaitIdle, Strobe(5), WaitIdle, Clear]);
        }
    }
    script
}

/// Plays the longest valid delay, from an empty ring to one that has wrapped.
fn longest_delay(tables: &TableLayout) -> Vec<Action> {
    let mut script = started();
    script.extend([Tap(1, 0, 128, 0), Tap(1, 1, 128, -2), Swap(1)]);
    for sample in 0..(1i64 << tables.ring_address_bits) + 8 {
        script.extend([StrobeExact(2 * sample + 1), WaitIdle]);
    }
    script
}
