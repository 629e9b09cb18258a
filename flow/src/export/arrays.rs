//! Impulses as tables of numbers. All have the designed impulses, in seconds; the C header also has the integer taps.

use super::{Selected, Selection, list};
use std::fmt::Write;

/// Two lines that describe the numbers, each after `comment`.
fn heading(selection: &Selection<'_>, comment: &str) -> String {
    let mut text = format!(
        "{comment} Shapers of {}, designed by posicast {}.\n\
         {comment} Times are in seconds after the first impulse; the amplitudes of an axis sum to 1.\n",
        selection.machine.name,
        crate::VERSION
    );
    for axis in &selection.axes {
        let _ = writeln!(text, "{comment} {}", axis.title());
    }
    text
}

/// A C header: for each axis the impulses, and the taps at the machine's sample rate.
pub(super) fn c(selection: &Selection<'_>) -> String {
    let machine = &selection.machine.name;
    let upper = machine.to_uppercase();
    let mut text = heading(selection, "//");
    let _ = write!(
        text,
        "// A tap delays its input by a number of samples and weighs it by coefficient / 2^{upper}_COEFFICIENT_FRACTION.\n\
         #ifndef {upper}_SHAPERS_H\n#define {upper}_SHAPERS_H\n\n#include <stdint.h>\n\n\
         #define {upper}_SAMPLE_HZ {:?}\n#define {upper}_COEFFICIENT_FRACTION {}\n",
        selection.design.sample_hz, selection.design.coefficient_fraction
    );
    for axis in &selection.axes {
        c_axis(&mut text, machine, axis);
    }
    let _ = write!(text, "\n#endif\n");
    text
}

fn c_axis(text: &mut String, machine: &str, selected: &Selected<'_>) {
    let name = format!("{machine}_{}", selected.axis.name);
    let upper = name.to_uppercase();
    let [times, amplitudes] = selected.columns();
    let taps = selected.tables.table.taps();
    let whole = |numbers: Vec<String>| numbers.join(", ");
    let delays = whole(taps.iter().map(|tap| tap.delay_samples.to_string()).collect());
    let coefficients = whole(taps.iter().map(|tap| tap.coefficient.to_string()).collect());
    let _ = write!(
        text,
        "\n#define {upper}_IMPULSES {}\n\
         static const double {name}_time_s[{upper}_IMPULSES] = {{{}}};\n\
         static const double {name}_amplitude[{upper}_IMPULSES] = {{{}}};\n\
         #define {upper}_TAPS {}\n\
         static const uint32_t {name}_delay_samples[{upper}_TAPS] = {{{delays}}};\n\
         static const int32_t {name}_coefficient[{upper}_TAPS] = {{{coefficients}}};\n",
        times.len(),
        list(&times, ", "),
        list(&amplitudes, ", "),
        taps.len(),
    );
}

/// Lines of axis, time and amplitude; `axis_of` returns the axis as it is written.
fn lines(selection: &Selection<'_>, separator: &str, axis_of: impl Fn(usize, &str) -> String) -> String {
    let mut text = String::new();
    for (number, selected) in selection.axes.iter().enumerate() {
        let axis = axis_of(number, &selected.axis.name);
        for impulse in selected.tables.design.impulses.impulses() {
            let numbers = list(&[impulse.time_s, impulse.amplitude], separator);
            let _ = writeln!(text, "{axis}{separator}{numbers}");
        }
    }
    text
}

/// CSV with a line of names.
pub(super) fn csv(selection: &Selection<'_>) -> String {
    "axis,time_s,amplitude\n".to_owned() + &lines(selection, ",", |_, name| name.to_owned())
}

/// Text for `numpy.loadtxt`, in which axes are numbers.
pub(super) fn numpy(selection: &Selection<'_>) -> String {
    let mut text = heading(selection, "#");
    let names = selection.axes.iter().enumerate();
    let names: Vec<String> = names
        .map(|(number, axis)| format!("{number} is {}", axis.axis.name))
        .collect();
    let _ = writeln!(
        text,
        "# columns: axis ({}), time_s, amplitude; read it with numpy.loadtxt",
        names.join(", ")
    );
    text + &lines(selection, " ", |number, _| number.to_string())
}

/// Keywords of MATLAB that the machine file allows as names.
const KEYWORDS: [&str; 9] = [
    "catch",
    "classdef",
    "elseif",
    "otherwise",
    "parfor",
    "persistent",
    "spmd",
    "switch",
    "try",
];

/// A name that MATLAB accepts: keywords get an underscore.
fn matlab_name(name: &str) -> String {
    let underscore = if KEYWORDS.contains(&name) { "_" } else { "" };
    format!("{name}{underscore}")
}

/// A script that makes `NAME.AXIS.time_s` and `NAME.AXIS.amplitude`, which Octave runs, too.
pub(super) fn matlab(selection: &Selection<'_>) -> String {
    let mut text = heading(selection, "%");
    for selected in &selection.axes {
        let name = format!(
            "{}.{}",
            matlab_name(&selection.machine.name),
            matlab_name(&selected.axis.name)
        );
        let [times, amplitudes] = selected.columns();
        let _ = write!(
            text,
            "{name}.time_s = [{}];\n{name}.amplitude = [{}];\n",
            list(&times, " "),
            list(&amplitudes, " ")
        );
    }
    text
}
