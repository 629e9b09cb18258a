//! A simple comparison with `wellen`: it loads both files, then compares each signal's changes.

use std::collections::BTreeMap;
use std::path::Path;

use wellen::{SignalRef, simple};

type Loaded = (simple::Waveform, BTreeMap<String, SignalRef>);

fn load(path: &Path) -> Loaded {
    let mut wave = simple::read(path).unwrap();
    let hierarchy = wave.hierarchy();
    let names: BTreeMap<String, SignalRef> = hierarchy
        .all_vars()
        .map(|var| (hierarchy[var].full_name(hierarchy), hierarchy[var].signal_ref()))
        .collect();
    let mut signals: Vec<SignalRef> = names.values().copied().collect();
    signals.sort();
    signals.dedup();
    wave.load_signals_multi_threaded(&signals);
    (wave, names)
}

/// Returns whether any signal that both files have has different changes, or changes at different times.
pub(crate) fn differs(a: &Path, b: &Path) -> bool {
    let (a, b): (Loaded, Loaded) = std::thread::scope(|scope| {
        let b = scope.spawn(|| load(b));
        (load(a), b.join().unwrap())
    });
    let mut differs = false;
    for (name, of_a) in &a.1 {
        let Some(of_b) = b.1.get(name) else { continue };
        let [of_a, of_b] = [(&a.0, of_a), (&b.0, of_b)].map(|(wave, signal)| {
            let times = wave.time_table();
            let changes = wave.get_signal(*signal).unwrap().iter_changes();
            changes.map(move |(time, value)| (times[time as usize], value))
        });
        differs |= !of_a.eq(of_b);
    }
    differs
}
