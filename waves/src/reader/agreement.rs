//! Compares our reader with the crates `vcd` and `wellen`: the same values at the same times, on a recording of each
//! producer.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use vcd::{Command, IdCode, Parser, VarType};
use wellen::simple;

use super::*;

/// Time and value of each real change, at most one per time; per signal, and sorted, because readers name the signals
/// differently.
type Changes = Vec<Vec<(u64, String)>>;

/// Normalises digits, the last of which is the least significant; `U`, `W` and `-` become `x`, `H` 1, `L` 0.
fn plain(digits: &str, width: usize) -> String {
    let digits: String = digits
        .chars()
        .map(|digit| match digit.to_ascii_lowercase() {
            'u' | 'w' | '-' => 'x',
            'h' => '1',
            'l' => '0',
            other => other,
        })
        .collect();
    let first = digits.chars().next();
    let fill = first.filter(|digit| "xz".contains(*digit)).unwrap_or('0');
    let missing = width.saturating_sub(digits.len());
    std::iter::repeat_n(fill, missing).chain(digits.chars()).collect()
}

fn note(changes: &mut Vec<(u64, String)>, time: u64, value: String) {
    if let Some(last) = changes.last_mut()
        && last.0 == time
    {
        last.1 = value;
    } else {
        changes.push((time, value));
    }
}

fn finished(signals: impl Iterator<Item = Vec<(u64, String)>>) -> Changes {
    let mut all: Changes = signals
        .map(|mut changes| {
            changes.dedup_by(|later, earlier| later.1 == earlier.1);
            changes
        })
        .collect();
    all.sort();
    all
}

fn ours(path: &Path) -> Changes {
    let (declarations, mut feed) = Wave::open(path).unwrap().play(None, FileEnd::Refuse).unwrap();
    let mut values = Values::new(&declarations.kinds);
    let mut changes = vec![Vec::new(); declarations.kinds.len()];
    while let Some(step) = feed.next_step().unwrap() {
        feed.each_change(|slot, words| {
            values.set(slot, words);
            let value = match values.get(slot) {
                bits @ Value::Bits { width, .. } => bits.digits(width, false),
                Value::Real(Some(real)) => real.to_string(),
                text @ Value::Text(_) => text.text().unwrap(),
                Value::Real(None) | Value::Event(_) => return,
            };
            note(&mut changes[slot as usize], step.time, value);
        });
    }
    let kinds = declarations.kinds.iter();
    let comparable = kinds.zip(changes).filter(|(kind, _)| **kind != Kind::Event);
    finished(comparable.map(|(_, changes)| changes))
}

fn by_vcd(path: &Path) -> Changes {
    let mut parser = Parser::new(BufReader::new(File::open(path).unwrap()));
    let mut signals: HashMap<IdCode, (usize, Vec<(u64, String)>)> = HashMap::new();
    let mut time = 0;
    while let Some(command) = parser.next().transpose().unwrap() {
        let (id, value) = match command {
            Command::VarDef(VarType::Event, ..) => continue,
            Command::VarDef(_, width, id, ..) => {
                signals.insert(id, (width as usize, Vec::new()));
                continue;
            }
            Command::Timestamp(next) => {
                time = next;
                continue;
            }
            Command::ChangeScalar(id, value) => (id, value.to_string()),
            Command::ChangeVector(id, vector) => (id, vector.to_string()),
            Command::ChangeReal(id, real) => (id, format!("r{real}")),
            Command::ChangeString(id, text) => (id, format!("s{text}")),
            _ => continue,
        };
        let Some((width, changes)) = signals.get_mut(&id) else {
            continue;
        };
        let value = match value.strip_prefix(['r', 's']) {
            Some(text) => text.to_owned(),
            None => plain(&value, *width),
        };
        note(changes, time, value);
    }
    finished(signals.into_values().map(|(_, changes)| changes))
}

fn by_wellen(path: &Path) -> Changes {
    use wellen::VarType;

    let mut wave = simple::read(path).unwrap();
    let hierarchy = wave.hierarchy();
    let mut signals = BTreeMap::new();
    for var in hierarchy.all_vars().map(|var| &hierarchy[var]) {
        if var.var_type() != VarType::Event {
            signals.insert(var.signal_ref(), (var.length(hierarchy), var.var_type()));
        }
    }
    let refs: Vec<_> = signals.keys().copied().collect();
    wave.load_signals(&refs);
    let signals = signals.into_iter().map(|(signal, (width, var_type))| {
        let mut changes = Vec::new();
        if let Some(signal) = wave.get_signal(signal) {
            for (time, value) in signal.iter_changes() {
                let text = value.to_string();
                let text = match var_type {
                    VarType::Real | VarType::RealTime | VarType::RealParameter | VarType::ShortReal => {
                        text.parse::<f64>().unwrap().to_string()
                    }
                    VarType::String => text,
                    _ => plain(&text, width.unwrap_or(1) as usize),
                };
                note(&mut changes, wave.time_table()[time as usize], text);
            }
        }
        changes
    });
    finished(signals)
}

fn fixtures() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/waves");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_wave = |path: &PathBuf| path.extension().is_some_and(|e| e == "vcd" || e == "fst");
    files.filter(is_wave).collect()
}

#[test]
fn golden_every_recording_reads_as_by_wellen() {
    let files = fixtures();
    assert!(files.len() >= 8, "{files:?}");
    for path in files {
        // The crate assembles single bits to a vector.
        if path.ends_with("modelsim_style.vcd") {
            continue;
        }
        let (ours, theirs) = (ours(&path), by_wellen(&path));
        assert!(ours.iter().map(Vec::len).sum::<usize>() > 100, "{path:?}");
        assert_eq!(ours, theirs, "{path:?}");
    }
}

#[test]
fn golden_every_vcd_reads_as_by_the_crate_vcd() {
    for path in fixtures() {
        // The crate supports neither VHDL's values nor FST.
        if path.extension().is_some_and(|e| e == "vcd") && !path.ends_with("ghdl.vcd") {
            assert_eq!(ours(&path), by_vcd(&path), "{path:?}");
        }
    }
}

/// Widths of the signals of a random file; their id codes are as long as their index.
const WIDTHS: [usize; 5] = [1, 5, 64, 65, 200];

fn random_file(changes: &[(usize, String, u64)]) -> String {
    let mut text = "$timescale 1 ns $end $scope module t $end\n".to_owned();
    let id = |at: usize| "!~a".repeat(at + 1)[..=at].to_owned();
    for (at, width) in WIDTHS.iter().enumerate() {
        text += &format!("$var wire {width} {} s{at} $end\n", id(at));
    }
    text += "$upscope $end $enddefinitions $end\n";
    let mut time = 0;
    for (at, digits, later) in changes {
        // Often the step is 0: an additional time stamp without effect.
        time += later / 2;
        let digits = &digits[..digits.len().min(WIDTHS[*at])];
        let (b, space) = if WIDTHS[*at] == 1 { ("", "") } else { ("b", " ") };
        text += &format!("#{time}\n{b}{digits}{space}{}\n", id(*at));
    }
    text
}

proptest! {
    #[test]
    fn prop_any_file_reads_as_by_the_crate_vcd(
        changes in prop::collection::vec((0..WIDTHS.len(), "[01xz]{1,8}|[01]{1,200}|[01xz]{1,200}", 0u64..6), 0..60),
    ) {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), random_file(&changes)).unwrap();
        prop_assert_eq!(ours(file.path()), by_vcd(file.path()));
    }
}
