//! Partial sums and tolerances of the convolution of several modes' shapers.

use crate::support;

use posicast_machine::machine_file::AxisSection;
use posicast_shaper::analysis::residual_vibration;
use posicast_shaper::design::{ConvolutionFigures, ConvolutionWarning, convolution_figures, design_axis};
use support::{machine, shaper};

/// Returns the two modes of the robot of the negative-impulse paper, with a kind and further lines for each.
fn robot(first: &str, second: &str) -> (AxisSection, ConvolutionFigures) {
    let modes = [(76.6, 0.057, first), (231.2, 0.017, second)];
    let mut machine = machine(10_000, "modal", &shaper("zv", 0.05), &modes);
    let axis = machine.axes.remove(0);
    let figures = convolution_figures(axis.shaped(), &design_axis(axis.shaped(), 10_000.0).unwrap());
    (axis, figures)
}

#[test]
fn negative_hybrids_are_warned_of_with_their_gain() {
    let (_, figures) = robot("shaper = \"ps-zv\"", "shaper = \"ps-ei\"");
    assert!((figures.peak_command - 5.0).abs() < 1e-12);
    let gains: Vec<_> = figures.cross_gains.iter().map(|g| (g.shaper, g.at)).collect();
    assert_eq!(gains, [(1, 0), (0, 1)]);
    // The notes on the paper give 3.37 to 3.42 for the mode-1 negative shaper at mode 2.
    assert!((figures.cross_gains[1].gain - 3.4245).abs() < 1e-4, "{figures:?}");
    let [
        ConvolutionWarning::PartialSums { sums, .. },
        ConvolutionWarning::Tolerance { residual, gain, .. },
    ] = figures.warnings[..]
    else {
        panic!("{figures:?}");
    };
    assert!((sums.min + 3.0).abs() < 1e-12 && (sums.max - 5.0).abs() < 1e-12);
    assert!((residual - 0.05 * gain).abs() < 1e-12);
    let text = figures.warnings[1].to_string();
    assert!(
        text.contains("231.2 Hz") && text.contains("tolerance = 0.0146"),
        "{text}"
    );
}

#[test]
fn the_remedy_of_the_warning_works() {
    let (axis, figures) = robot("shaper = \"ps-zv\"", "shaper = \"ps-ei\"\ntolerance = 0.0146");
    let residual = residual_vibration(
        design_axis(axis.shaped(), 10_000.0).unwrap().impulses.impulses(),
        &axis.modes[1].mode,
    );
    assert!((0.0499..=0.05).contains(&residual), "{residual}");
    // The residual is still compared with the mode's own tolerance, now the smaller one: nothing is hidden.
    assert_eq!(figures.warnings.len(), 2);
}

#[test]
fn positive_hybrids_and_one_negative_shaper_raise_no_warning() {
    for (first, second) in [("zvd", "ei"), ("ei", "zv"), ("mzv", "two-hump-ei"), ("zv-ei", "zvd")] {
        let [first, second] = [first, second].map(|kind| format!("shaper = \"{kind}\""));
        let (_, figures) = robot(&first, &second);
        assert!(figures.warnings.is_empty(), "{figures:?}");
        assert!(figures.cross_gains.iter().all(|g| g.gain <= 1.0));
    }
    let (_, figures) = robot("shaper = \"zvd\"", "shaper = \"ps-zv\"");
    assert!(
        figures.warnings.is_empty() && figures.peak_command <= 1.0 + 1e-12,
        "{figures:?}"
    );
}

#[test]
fn kinds_for_the_whole_axis_have_no_cross_gains() {
    let machine = machine(10_000, "modal", "kind = \"none\"", &[(10.0, 0.1, ""), (30.0, 0.1, "")]);
    let axis = &machine.axes[0];
    let figures = convolution_figures(axis.shaped(), &design_axis(axis.shaped(), 10_000.0).unwrap());
    assert!(figures.cross_gains.is_empty() && figures.warnings.is_empty());
    assert_eq!(figures.peak_command, 1.0);
}
