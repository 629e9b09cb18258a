//! The PLL of Lattice's ECP5 (`EHXPLLL`) before the example, for boards whose oscillator has another frequency than the
//! design's clock.
//!
//! ```text
//! oscillator / reference ─► phase detector ─► VCO ─┬─► / output ──► clock
//!             ▲                                    │
//!             └───────── / feedback ◄─ / loop ─────┘
//! ```
//!
//! The clock is exactly that of the machine file, because the sample rate depends on it: an oscillator is left out if this clock cannot be
//! made from it. Limits are those of Lattice's data sheet FPGA-DS-02012 (table of the sysCLOCK PLL).

use std::fmt::Write;

use super::Kit;
use super::example;

/// Frequencies of oscillators on boards, in Hz.
const OSCILLATORS_HZ: [u64; 7] = [
    12_000_000,
    16_000_000,
    25_000_000,
    27_000_000,
    48_000_000,
    50_000_000,
    100_000_000,
];
/// Range of the VCO in Hz, and its middle, which is the best frequency.
const VCO_HZ: std::ops::RangeInclusive<u64> = 400_000_000..=800_000_000;
const VCO_MIDDLE_HZ: u64 = 600_000_000;
/// Lowest frequency of an output and of the phase detector, in Hz; the highest is not reached from these oscillators.
const LEAST_HZ: u64 = 3_125_000;
/// Largest frequency of an output in Hz.
const MOST_HZ: u64 = 400_000_000;
/// Largest value of a divider.
const DIVIDER_MAX: u64 = 128;

/// Dividers of the PLL, each 1 to 128.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Dividers {
    /// `CLKI_DIV`.
    reference: u64,
    /// `CLKFB_DIV`.
    feedback: u64,
    /// `CLKOP_DIV`, of the output that is fed back.
    fed_back: u64,
    /// `CLKOS_DIV`, of the output that is the clock.
    output: u64,
}

/// Returns the dividers that make exactly `clock_hz` from `oscillator_hz`, with the VCO as near to its middle as possible; `None` if there
/// are none.
fn dividers(oscillator_hz: u64, clock_hz: u64) -> Option<Dividers> {
    if !(LEAST_HZ..=MOST_HZ).contains(&clock_hz) {
        return None;
    }
    let mut outputs: Vec<u64> = (1..=DIVIDER_MAX)
        .filter(|output| VCO_HZ.contains(&(clock_hz * output)))
        .collect();
    outputs.sort_by_key(|output| (clock_hz * output).abs_diff(VCO_MIDDLE_HZ));
    let places = outputs.into_iter().flat_map(|output| {
        let references = (1..=DIVIDER_MAX).take_while(|reference| LEAST_HZ * reference <= oscillator_hz);
        references.map(move |reference| (output, reference))
    });
    let mut found = places.filter_map(|(output, reference)| {
        let vco = clock_hz * output * reference;
        let total = vco.is_multiple_of(oscillator_hz).then(|| vco / oscillator_hz)?;
        let mut splits = 1..=DIVIDER_MAX;
        let feedback = splits.find(|d| total.is_multiple_of(*d) && total / d <= DIVIDER_MAX)?;
        Some(Dividers {
            reference,
            feedback,
            fed_back: total / feedback,
            output,
        })
    });
    found.next()
}

/// The clock in whole Hz; `None` if it has a fraction.
fn clock_hz(kit: &Kit<'_>) -> Option<u64> {
    (kit.clock_hz.fract() == 0.0).then_some(kit.clock_hz as u64)
}

/// The oscillators from which a PLL makes the design's clock, with its dividers.
fn choices(kit: &Kit<'_>) -> Vec<(u64, Dividers)> {
    let clock = clock_hz(kit);
    let others = OSCILLATORS_HZ.into_iter().filter(|hz| Some(*hz) != clock);
    others
        .filter_map(|oscillator| Some((oscillator, dividers(oscillator, clock?)?)))
        .collect()
}

/// The frequencies of oscillators for which there is a PLL, in Hz.
pub(super) fn oscillators(kit: &Kit<'_>) -> Vec<u64> {
    choices(kit).into_iter().map(|(oscillator, _)| oscillator).collect()
}

/// Writes the PLL, and the example behind it; `None` if no oscillator suits.
pub(super) fn verilog(kit: &Kit<'_>) -> Option<String> {
    let choices = choices(kit);
    let (first, _) = choices.first()?;
    let (machine, mhz) = (kit.machine, kit.clock_hz / 1e6);
    let mut text = String::new();
    example::header(
        &mut text,
        kit,
        &format!("{mhz} MHz from the oscillator of a board with a Lattice ECP5, and the example behind it."),
    );
    let _ = write!(
        text,
        "\
`default_nettype none

module {machine}_pll #(
    parameter OSCILLATOR_HZ = {first}
) (
    input  wire oscillator,
    output wire clk,
    output wire locked
);
    wire fed_back;

    generate
"
    );
    for (index, (oscillator, dividers)) in choices.iter().enumerate() {
        let start = if index == 0 { "        if" } else { " else if" };
        let _ = write!(
            text,
            "{start} (OSCILLATOR_HZ == {oscillator}) begin : from_{oscillator}\n{}        end",
            pll(*dividers)
        );
    }
    let _ = write!(
        text,
        " else begin : unknown
            // No dividers are known for this oscillator: this module does not exist.
            {machine}_pll_has_no_dividers_for_this_oscillator missing ();
        end
    endgenerate
endmodule

// The example with its clock from the PLL; it is in reset until the PLL has locked.
module {machine}_on_board #(
    parameter OSCILLATOR_HZ = {first}
) (
    input  wire oscillator,
{ports}    output wire strobe
);
    wire clk, locked;
    reg  [3:0] runs = 4'd0;

    {machine}_pll #(.OSCILLATOR_HZ(OSCILLATOR_HZ)) u_pll (.oscillator(oscillator), .clk(clk), .locked(locked));

    always @(posedge clk or negedge locked)
        if (!locked) runs <= 4'd0;
        else         runs <= {{runs[2:0], 1'b1}};

    {machine}_example u_example (
        .clk(clk),
        .rst(~runs[3]),
",
        ports = example::ports(kit),
    );
    for shaper in kit.shapers {
        for signal in example::signals(shaper) {
            let name = format!("{}_{signal}", shaper.axis);
            let _ = writeln!(text, "        .{name}({name}),");
        }
    }
    text.push_str("        .strobe(strobe)\n    );\nendmodule\n\n`default_nettype wire\n");
    Some(text)
}

/// The instance of the primitive.
fn pll(dividers: Dividers) -> String {
    let Dividers {
        reference,
        feedback,
        fed_back,
        output,
    } = dividers;
    // Without a phase shift an output's coarse phase is its divider less one.
    format!(
        "            EHXPLLL #(
                .PLLRST_ENA(\"DISABLED\"),
                .INTFB_WAKE(\"DISABLED\"),
                .STDBY_ENABLE(\"DISABLED\"),
                .DPHASE_SOURCE(\"DISABLED\"),
                .OUTDIVIDER_MUXA(\"DIVA\"),
                .OUTDIVIDER_MUXB(\"DIVB\"),
                .CLKI_DIV({reference}),
                .FEEDBK_PATH(\"CLKOP\"),
                .CLKFB_DIV({feedback}),
                .CLKOP_ENABLE(\"ENABLED\"),
                .CLKOP_DIV({fed_back}),
                .CLKOP_CPHASE({}),
                .CLKOP_FPHASE(0),
                .CLKOS_ENABLE(\"ENABLED\"),
                .CLKOS_DIV({output}),
                .CLKOS_CPHASE({}),
                .CLKOS_FPHASE(0)
            ) u_pll (
                .CLKI(oscillator),
                .CLKFB(fed_back),
                .CLKOP(fed_back),
                .CLKOS(clk),
                .LOCK(locked),
                .RST(1'b0),
                .STDBY(1'b0),
                .PHASESEL0(1'b0),
                .PHASESEL1(1'b0),
                .PHASEDIR(1'b0),
                .PHASESTEP(1'b0),
                .PHASELOADREG(1'b0),
                .PLLWAKESYNC(1'b0),
                .ENCLKOP(1'b0)
            );
",
        fed_back - 1,
        output - 1,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_the_dividers_match_project_trellis() {
        // `ecppll -i 48 -o 50 --highres`: "Refclk divisor: 2, Feedback divisor: 1, clkout0 divisor: 25, clkout1 divisor:
        // 12, VCO frequency: 600".
        let expected = Dividers {
            reference: 2,
            feedback: 1,
            fed_back: 25,
            output: 12,
        };
        assert_eq!(dividers(48_000_000, 50_000_000), Some(expected));
    }

    #[test]
    fn every_pll_makes_its_clock_exactly_and_within_the_limits() {
        let mut found = 0;
        for clock_hz in [
            10_000_000,
            20_000_000,
            48_000_000,
            50_000_000,
            62_500_000,
            100_000_000,
            125_000_000,
        ] {
            for oscillator_hz in OSCILLATORS_HZ {
                let Some(of) = dividers(oscillator_hz, clock_hz) else {
                    continue;
                };
                found += 1;
                let vco_hz = clock_hz * of.output;
                assert_eq!(
                    oscillator_hz * of.feedback * of.fed_back,
                    vco_hz * of.reference,
                    "{of:?}"
                );
                assert!(
                    VCO_HZ.contains(&vco_hz) && oscillator_hz / of.reference >= LEAST_HZ,
                    "{of:?}"
                );
                let all = [of.reference, of.feedback, of.fed_back, of.output];
                assert!(all.iter().all(|divider| (1..=DIVIDER_MAX).contains(divider)), "{of:?}");
            }
        }
        assert!(found > 40, "{found}");
        // The output frequency is too low for a PLL, and the ratio cannot be made.
        assert_eq!(dividers(25_000_000, 1_000_000), None);
        assert_eq!(dividers(27_000_000, 50_000_001), None);
    }
}
