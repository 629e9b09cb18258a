//! The same waves as different producers write them are equal, and one digit that differs is found at its place.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict};

/// Widths of the vectors `v0`, `v1` …; after them comes the real number `r`.
const WIDTHS: [usize; 6] = [1, 1, 4, 13, 64, 70];
const REAL: usize = WIDTHS.len();

/// By time in nanoseconds and signal: digits, or a number in eighths.
type Waves = BTreeMap<u64, BTreeMap<usize, String>>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dialect {
    /// Every digit, id codes of one character.
    Plain,
    /// Digits in upper case, as few as give the value, id codes of four characters and more; 100 ps.
    Short,
    /// Single bits as vectors, `$dumpvars` that no `$end` closes, unnamed scopes, comments, `\v [3:0]`.
    Open,
    /// A digit as the whole vector where all are equal, values that are written again, a space before the id code.
    Repeated,
    /// Vectors bit by bit, the last first.
    Bits,
    /// Vectors in two parts, the second time an id code of its own.
    Parts,
    /// FST, in blocks of three times.
    Fst,
}

const DIALECTS: [Dialect; 7] = [
    Dialect::Plain,
    Dialect::Short,
    Dialect::Open,
    Dialect::Repeated,
    Dialect::Bits,
    Dialect::Parts,
    Dialect::Fst,
];

/// Returns as few digits as a reader extends to the same.
fn short(digits: &str) -> &str {
    let mut rest = digits;
    while rest.len() > 1 {
        let fill = match &rest[1..2] {
            "1" => "0",
            other => other,
        };
        if &rest[..1] != fill {
            break;
        }
        rest = &rest[1..];
    }
    rest
}

fn real(eighths: &str) -> f64 {
    eighths.parse::<f64>().unwrap() / 8.0
}

impl Dialect {
    fn id(self, signal: usize, part: usize) -> String {
        match self {
            Self::Short => format!("sig.{signal}"),
            Self::Bits | Self::Parts => format!("{}{part}", char::from(b'a' + signal as u8)),
            _ => char::from(b'!' + signal as u8).to_string(),
        }
    }

    /// Returns the lowest index and the width of each part of a vector, as they are declared.
    fn parts(self, width: usize) -> Vec<(usize, usize)> {
        match self {
            Self::Bits if width > 1 => (0..width).rev().map(|bit| (bit, 1)).collect(),
            Self::Parts if width > 1 => vec![(width / 3, width - width / 3), (0, width / 3)],
            _ => vec![(0, width)],
        }
        .into_iter()
        .filter(|(_, width)| *width > 0)
        .collect()
    }

    fn write(self, waves: &Waves, folder: &Path) -> PathBuf {
        if self == Self::Fst {
            return write_fst(waves, folder);
        }
        let (unit, ticks) = if self == Self::Short {
            ("100 ps", 10)
        } else {
            ("1ns", 1)
        };
        let mut text = format!("$timescale {unit} $end\n$scope module t $end\n");
        if self == Self::Open {
            text += "$scope module $end\n";
        }
        for (signal, width) in WIDTHS.iter().enumerate() {
            for (part, (low, count)) in self.parts(*width).into_iter().enumerate() {
                let range = match (self, *width) {
                    (_, 1) => String::new(),
                    (Self::Bits, _) => format!(" [{low}]"),
                    (Self::Plain, _) => format!("[{}:{low}]", low + count - 1),
                    _ => format!(" [{}:{low}]", low + count - 1),
                };
                let _ = writeln!(
                    text,
                    "$var wire {count} {} v{signal}{range} $end",
                    self.id(signal, part)
                );
            }
        }
        let _ = writeln!(text, "$var real 64 {} r $end", self.id(REAL, 0));
        if self == Self::Open {
            text += "$upscope $end\n";
        }
        text += "$upscope $end\n$enddefinitions $end\n";
        let mut known: BTreeMap<usize, String> = BTreeMap::new();
        for (number, (time, changes)) in waves.iter().enumerate() {
            let _ = writeln!(text, "#{}", time * ticks);
            if number == 0 && matches!(self, Self::Open | Self::Plain) {
                text += "$dumpvars\n";
            }
            known.extend(changes.clone());
            let all = self == Self::Repeated && number % 3 == 1;
            for (signal, value) in if all { &known } else { changes } {
                self.write_value(&mut text, *signal, value);
            }
            if number == 0 && self == Self::Plain {
                text += "$end\n";
            }
            if self == Self::Open && number % 4 == 2 {
                text += "$comment #99999 1! $end\n";
            }
        }
        let path = folder.join(format!("{self:?}.vcd"));
        std::fs::write(&path, text).unwrap();
        path
    }

    fn write_value(self, text: &mut String, signal: usize, value: &str) {
        if signal == REAL {
            let _ = writeln!(text, "r{} {}", real(value), self.id(REAL, 0));
            return;
        }
        let width = value.len();
        for (part, (low, count)) in self.parts(width).into_iter().enumerate() {
            let digits = &value[width - low - count..width - low];
            let id = self.id(signal, part);
            let _ = match self {
                Self::Short if count > 1 => writeln!(text, "B{} {id}", short(digits).to_uppercase()),
                Self::Open => writeln!(text, "b{digits} {id}"),
                Self::Repeated if count > 1 => writeln!(text, "b{}  {id}", short(digits)),
                Self::Repeated => writeln!(text, "{digits} {id}"),
                _ if count == 1 => writeln!(text, "{digits}{id}"),
                _ => writeln!(text, "b{digits} {id}"),
            };
        }
    }
}

fn write_fst(waves: &Waves, folder: &Path) -> PathBuf {
    use fst_writer::{FstFileType, FstInfo, FstScopeType, FstSignalType, FstVarDirection, FstVarType, open_fst};

    let path = folder.join("Fst.fst");
    let info = FstInfo {
        start_time: 0,
        timescale_exponent: -9,
        version: String::new(),
        date: String::new(),
        file_type: FstFileType::Verilog,
    };
    let mut head = open_fst(&path, &info).unwrap();
    head.scope("t", "", FstScopeType::Module).unwrap();
    let mut ids = Vec::new();
    for (signal, width) in WIDTHS.iter().enumerate() {
        let name = match width {
            1 => format!("v{signal}"),
            _ => format!("v{signal} [{}:0]", width - 1),
        };
        let kind = FstSignalType::bit_vec(*width as u32);
        ids.push(
            head.var(&name, kind, FstVarType::Wire, FstVarDirection::Implicit, None)
                .unwrap(),
        );
    }
    let kind = FstSignalType::real();
    ids.push(
        head.var("r", kind, FstVarType::Real, FstVarDirection::Implicit, None)
            .unwrap(),
    );
    head.up_scope().unwrap();
    let mut body = head.finish().unwrap();
    for (number, (time, changes)) in waves.iter().enumerate() {
        if number > 0 && number % 3 == 0 {
            body.flush().unwrap();
        }
        body.time_change(*time).unwrap();
        for (signal, value) in changes {
            if *signal == REAL {
                body.signal_change(ids[REAL], &real(value).to_le_bytes()).unwrap();
            } else {
                body.signal_change(ids[*signal], value.as_bytes()).unwrap();
            }
        }
    }
    body.finish().unwrap();
    path
}

fn compare(a: &Path, b: &Path) -> Comparison {
    let options = DiffOptions {
        raw: true,
        ..DiffOptions::default()
    };
    diff::compare(a, b, &options, &mut |_| {}).unwrap()
}

fn digits(width: usize) -> impl Strategy<Value = String> {
    let digits = prop::sample::select(vec!["[01]", "[01]", "[01x]", "[01xz]", "[x]", "[z]", "[0]"]);
    digits.prop_flat_map(move |digits| proptest::string::string_regex(&format!("{digits}{{{width}}}")).unwrap())
}

fn change() -> impl Strategy<Value = (usize, String)> {
    (0..=REAL).prop_flat_map(|signal| {
        let value = match WIDTHS.get(signal) {
            Some(width) => digits(*width).boxed(),
            None => (-1000i32..1000).prop_map(|eighths| eighths.to_string()).boxed(),
        };
        (Just(signal), value)
    })
}

/// All signals have a value at 0, and change at some of the times after that.
fn waves() -> impl Strategy<Value = Waves> {
    let first = WIDTHS.map(digits).into_iter().collect::<Vec<_>>();
    let later = prop::collection::vec((1u64..5, prop::collection::vec(change(), 1..5)), 1..14);
    (first, later).prop_map(|(first, later)| {
        let mut all: BTreeMap<usize, String> = first.into_iter().enumerate().collect();
        all.insert(REAL, "4".to_owned());
        let mut waves = Waves::from([(0, all)]);
        let mut time = 0;
        for (by, changes) in later {
            time += by;
            waves.insert(time, changes.into_iter().collect());
        }
        waves
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_all_dialects_compare_equal_and_one_changed_digit_is_found(
        waves in waves(), which: prop::sample::Index, place: prop::sample::Index, dialects in [0..DIALECTS.len(), 0..DIALECTS.len()],
    ) {
        let folder = tempfile::tempdir().unwrap();
        let files: Vec<PathBuf> = DIALECTS.iter().map(|dialect| dialect.write(&waves, folder.path())).collect();
        let [one, other] = dialects;
        let same = compare(&files[one], &files[other]);
        prop_assert_eq!(same.result, DiffVerdict::Equal, "{:?} {:?}: {}", DIALECTS[one], DIALECTS[other], same);
        prop_assert_eq!(same.differences.len(), 0);
        prop_assert!(same.signals as usize > WIDTHS.len(), "{}", same);

        let changes: Vec<(u64, usize)> = waves.iter().flat_map(|(time, changes)| changes.keys().map(|signal| (*time, *signal))).collect();
        let (time, signal) = changes[which.index(changes.len())];
        let mut changed = waves.clone();
        let value = changed.get_mut(&time).unwrap().get_mut(&signal).unwrap();
        if signal == REAL {
            *value = (value.parse::<i32>().unwrap() + 1).to_string();
        } else {
            let at = place.index(value.len());
            let digit = if &value[at..=at] == "1" { "0" } else { "1" };
            value.replace_range(at..=at, digit);
        }
        let elsewhere = folder.path().join("changed");
        std::fs::create_dir(&elsewhere).unwrap();
        let wrong = DIALECTS[other].write(&changed, &elsewhere);
        for [a, b] in [[&files[one], &wrong], [&wrong, &files[one]]] {
            let found = compare(a, b);
            prop_assert_eq!(found.differences.len(), 1, "{:?} {:?}: {}", DIALECTS[one], DIALECTS[other], found);
            let name = if signal == REAL { "r".to_owned() } else { format!("v{signal}") };
            let difference = &found.differences[0];
            prop_assert!(difference.signal.starts_with(&format!("t.{name}")), "{}", found);
            prop_assert!((difference.time - time as f64 * 1e-9).abs() < 1e-15, "{} at {} ns: {}", name, time, found);
        }
    }
}
