//! Writes small pairs of files on which comparers of waveforms disagree, with the verdict that each pair deserves.
//!
//! ```sh
//! cargo run -p wavecmp --example small_pairs -- DIR        # writes DIR/NAME.a.vcd, DIR/NAME.b.vcd; prints names and verdicts
//! ```
//!
//! The tests in `tests/complaints.rs` compare each of them, and the table in the README says what other tools answer.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // an example stops where it fails

/// What is right for a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Deserves {
    /// Nothing that was compared differs.
    Equal,
    /// Something differs.
    Different,
    /// There is nothing to compare.
    Incomparable,
}

/// Two files.
#[derive(Debug, Clone)]
pub(crate) struct SmallPair {
    /// Name of the files.
    pub(crate) name: &'static str,
    /// Contents of the two files.
    pub(crate) texts: [String; 2],
    /// Verdict of a comparison with a tolerance of 0.001 for real numbers.
    pub(crate) deserves: Deserves,
}

/// Returns a recording: a clock of the period in ns, 16 bits and a real number; `values` clock by clock. With the period 0, the
/// clock stands still, and the values change every 10 ns.
pub(crate) fn vcd(period: usize, name: &str, values: &[u32]) -> String {
    let mut text = format!(
        "$timescale 1ns $end\n$scope module t $end\n$var wire 1 ! clk $end\n$var wire 16 \" {name} [15:0] $end\n\
         $var real 64 r level $end\n$upscope $end\n$enddefinitions $end\n#0\n0!\nb0 \"\nr0.5 r\n"
    );
    for (at, value) in (1..).zip(values) {
        if period > 0 {
            let [rise, fall] = [period * at - period / 2, period * at];
            text += &format!("#{rise}\n1!\n#{fall}\n0!\nb{value:b} \"\n");
        } else {
            text += &format!("#{}\nb{value:b} \"\n", 10 * at);
        }
    }
    text
}

/// Returns all pairs.
pub(crate) fn small_pairs() -> Vec<SmallPair> {
    let usual = vcd(10, "y", &[1, 2, 3, 4, 5]);
    let still = [7; 10];
    let pair = |name, b: String, deserves| SmallPair {
        name,
        texts: [usual.clone(), b],
        deserves,
    };
    let other = |name, texts, deserves| SmallPair { name, texts, deserves };
    let renamed = usual.replace('"', "@").replace('!', "\"").replace('@', "!");
    vec![
        pair("value", vcd(10, "y", &[1, 2, 4, 4, 5]), Deserves::Different),
        pair("other_id_codes", renamed, Deserves::Equal),
        pair("other_timescale", in_picoseconds(&usual), Deserves::Equal),
        pair(
            "vector_behind_tolerance",
            vcd(10, "y", &[1, 2, 4, 4, 5]).replace("r0.5 r", "r0.5004 r"),
            Deserves::Different,
        ),
        pair(
            "real_within_tolerance",
            usual.replace("r0.5 r", "r0.5004 r"),
            Deserves::Equal,
        ),
        pair(
            "nothing_in_common",
            vcd(10, "z", &[1, 2, 3, 4, 5])
                .replace("level", "height")
                .replace("clk", "ck"),
            Deserves::Incomparable,
        ),
        pair("ends_early", vcd(10, "y", &[1, 2, 3]), Deserves::Different),
        other(
            "clock_at_half_rate",
            [vcd(10, "y", &still), vcd(20, "y", &still[..5])],
            Deserves::Different,
        ),
        other(
            "clock_stands_still",
            [vcd(10, "y", &still), vcd(0, "y", &still)],
            Deserves::Incomparable,
        ),
        pair(
            "x_instead_of_0",
            usual.replacen("b0 \"", "bx \"", 1),
            Deserves::Different,
        ),
        pair(
            "register_a_nanosecond_later",
            a_nanosecond_later(&usual),
            Deserves::Equal,
        ),
    ]
}

/// The same in another unit.
fn in_picoseconds(text: &str) -> String {
    let lines = text.lines().map(|line| match line.strip_prefix('#') {
        Some(time) if time != "0" => format!("#{time}000\n"),
        _ => format!("{}\n", line.replace("1ns", "1ps")),
    });
    lines.collect()
}

/// The same with each change of the vector a nanosecond later than the edge of the clock.
fn a_nanosecond_later(text: &str) -> String {
    let mut time = 0;
    let mut later = String::new();
    for line in text.lines() {
        if let Some(number) = line.strip_prefix('#') {
            time = number.parse().unwrap_or(0);
        }
        if line.starts_with('b') && time > 0 {
            later += &format!("#{}\n", time + 1);
        }
        later += &format!("{line}\n");
    }
    later
}

/// Writes the pairs.
#[allow(dead_code)] // the tests only read them
fn main() {
    let folder = std::path::PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    std::fs::create_dir_all(&folder).unwrap();
    for SmallPair { name, texts, deserves } in small_pairs() {
        for (file, text) in ["a", "b"].iter().zip(texts) {
            std::fs::write(folder.join(format!("{name}.{file}.vcd")), text).unwrap();
        }
        println!("{name}: {deserves:?}");
    }
}
