//! Readers of the exported text, each as its firmware reads it.

use std::collections::HashMap;
use std::f64::consts::PI;

/// Times in s and amplitudes, which sum to 1.
pub(crate) type Impulses = Vec<[f64; 2]>;

fn numbers(text: &str, separator: char) -> Vec<f64> {
    text.split(separator)
        .map(|number| number.trim().parse().unwrap())
        .collect()
}

/// What Klipper's own code makes of a kind at 50 Hz (`klipper.txt`).
pub(crate) fn klippers_own(version: &str, kind: &str, damping: f64) -> Option<Impulses> {
    include_str!("klipper.txt")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .find_map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            let found = words[0] == version && words[1] == kind && words[2].parse() == Ok(damping);
            found.then(|| {
                let (times, amplitudes) = (numbers(words[3], ','), numbers(words[4], ','));
                times.into_iter().zip(amplitudes).map(|(t, a)| [t, a]).collect()
            })
        })
}

/// The options of `[input_shaper]`, as `configparser` reads them: comments begin with # or ;, a later option replaces an earlier one.
pub(crate) fn config(text: &str) -> HashMap<String, String> {
    let mut section = String::new();
    let mut options = HashMap::new();
    for line in text.lines() {
        let line = line.split(['#', ';']).next().unwrap().trim_end();
        if let Some(name) = line.strip_prefix('[') {
            section = name.trim_end_matches(']').to_owned();
        } else if !line.is_empty() && section == "input_shaper" {
            let (key, value) = line.split_once([':', '=']).unwrap_or_else(|| panic!("{line}"));
            options.insert(key.trim().to_lowercase(), value.trim().to_owned());
        }
    }
    options
}

/// What an axis gets from `[input_shaper]`, and the kernel where it is a smoother.
pub(crate) enum OfKlipper {
    Impulses(Impulses),
    Smoother(Smoother),
}

/// A polynomial of t/T, highest power first, over −T/2 … T/2.
pub(crate) struct Smoother {
    pub(crate) duration_s: f64,
    pub(crate) falling: Vec<f64>,
}

impl Smoother {
    /// What it leaves of a mode, integrated as Klipper's `shaper_calibrate` describes it.
    pub(crate) fn residual(&self, frequency_hz: f64, damping: f64) -> f64 {
        const STEPS: usize = 20_000;
        let omega = 2.0 * PI * frequency_hz;
        let damped = omega * (1.0 - damping * damping).sqrt();
        let (mut sine, mut cosine, mut whole) = (0.0, 0.0, 0.0);
        for step in 0..STEPS {
            let since_end = self.duration_s * (step as f64 + 0.5) / STEPS as f64;
            let at = 0.5 - since_end / self.duration_s;
            let weight = self.falling.iter().fold(0.0, |sum, coefficient| sum * at + coefficient);
            whole += weight;
            sine += weight * (-damping * omega * since_end).exp() * (damped * since_end).sin();
            cosine += weight * (-damping * omega * since_end).exp() * (damped * since_end).cos();
        }
        sine.hypot(cosine) / whole
    }
}

/// What Klipper, or one of its branches, makes of the section for an axis.
pub(crate) fn klipper(text: &str, axis: &str, version: &str) -> OfKlipper {
    let options = config(text);
    let option = |name: &str| options.get(&format!("{name}_{axis}")).map(String::as_str);
    let kind = option("shaper_type").unwrap_or("mzv").to_lowercase();
    if kind == "custom" {
        let list = |name: &str| numbers(option(name).unwrap(), ',');
        let (amplitudes, times) = (list("shaper_a"), list("shaper_t"));
        // What the branches check.
        assert_eq!(amplitudes.len(), times.len());
        assert!(amplitudes.len() <= 5, "their shapers have room for 5 pulses");
        assert!(amplitudes.iter().all(|a| a.abs() >= 0.001));
        assert!(times.is_sorted());
        let duration = times.last().unwrap() - times[0];
        assert!((0.001..=0.2).contains(&duration), "{duration}");
        let sum: f64 = amplitudes.iter().sum();
        assert!(sum >= 0.001);
        let pairs = times.iter().zip(&amplitudes).map(|(t, a)| [t - times[0], a / sum]);
        return OfKlipper::Impulses(pairs.collect());
    }
    if kind == "smoother" {
        let falling = numbers(option("coeffs").unwrap(), ',');
        assert!((2..=12).contains(&falling.len()));
        return OfKlipper::Smoother(Smoother {
            duration_s: option("smooth_time").unwrap().parse().unwrap(),
            falling,
        });
    }
    let frequency: f64 = option("shaper_freq").map_or(0.0, |text| text.parse().unwrap());
    if frequency == 0.0 {
        return OfKlipper::Impulses(vec![[0.0, 1.0]]);
    }
    let damping: f64 = option("damping_ratio").map_or(0.1, |text| text.parse().unwrap());
    let at_50 = klippers_own(version, &kind, damping)
        .or_else(|| klippers_own("new", &kind, damping))
        .unwrap_or_else(|| panic!("klipper.txt has no {version} {kind} {damping}"));
    OfKlipper::Impulses(at_50.into_iter().map(|[t, a]| [t * 50.0 / frequency, a]).collect())
}

/// The parameters of a line of G-code: letters with what follows them.
fn parameters(line: &str) -> HashMap<char, String> {
    let code = line.split(';').next().unwrap();
    let words = code.split_whitespace().skip(1);
    words
        .map(|word| {
            let letter = word.chars().next().unwrap();
            (letter, word[1..].to_owned())
        })
        .collect()
}

fn command<'a>(text: &'a str, name: &str) -> &'a str {
    let mut lines = text.lines().filter(|line| line.starts_with(name));
    let line = lines.next().unwrap_or_else(|| panic!("{name} in {text}"));
    assert!(lines.next().is_none(), "two {name}");
    line
}

/// RepRapFirmware's `AxisShaper::Configure`: 3.5 (`sums`) or 3.6.
pub(crate) fn reprapfirmware(text: &str, from_3_6: bool) -> Impulses {
    const CLOCK_HZ: f64 = 750_000.0;
    let given = parameters(command(text, "M593"));
    if given[&'P'] == "\"none\"" {
        return vec![[0.0, 1.0]];
    }
    assert_eq!(given[&'P'], "\"custom\"");
    // Its numbers are 32-bit floats.
    let floats = |text: &str| -> Vec<f64> { numbers(text, ':').into_iter().map(|n| f64::from(n as f32)).collect() };
    let h = floats(&given[&'H']);
    assert!((1..=4).contains(&h.len()));
    let frequency: f64 = given.get(&'F').map_or(40.0, |f| f.parse().unwrap());
    let zeta: f64 = given.get(&'S').map_or(0.05, |s| s.parse().unwrap());
    assert!((CLOCK_HZ / (2.0 * 65535.0)..=1000.0).contains(&frequency));
    let period = CLOCK_HZ / (frequency * (1.0 - zeta * zeta).sqrt());
    let delays: Vec<f64> = match (given.get(&'T'), from_3_6) {
        (Some(t), true) => {
            let mut t = floats(t);
            // One number is padded to the whole array, which then is too long for H.
            if t.len() == 1 {
                t.resize(4, t[0]);
            }
            assert_eq!(
                t.len(),
                h.len(),
                "Number of delays must be same as number of amplitudes"
            );
            assert!(t[0] > 0.0 && t.windows(2).all(|pair| pair[1] > pair[0]));
            t.into_iter()
                .map(|seconds| (seconds * CLOCK_HZ).round() / CLOCK_HZ)
                .collect()
        }
        (None, true) => {
            let period = period.round();
            (1..=h.len())
                .map(|i| (period * i as f64 / 2.0).floor() / CLOCK_HZ)
                .collect()
        }
        (Some(t), false) => {
            let mut t = floats(t);
            if t.len() == 1 {
                t.resize(h.len(), t[0]);
            }
            assert_eq!(t.len(), h.len(), "Too few durations given");
            t.iter()
                .scan(0.0, |sum, interval| {
                    *sum += interval;
                    Some(*sum)
                })
                .collect()
        }
        (None, false) => (1..=h.len()).map(|i| 0.5 * period * i as f64 / CLOCK_HZ).collect(),
    };
    // 3.6: amplitudes. 3.5: the acceleration of each segment, as a part of the whole.
    let mut amplitudes = h.clone();
    if !from_3_6 {
        for i in (1..h.len()).rev() {
            amplitudes[i] -= h[i - 1];
        }
    }
    amplitudes.push(1.0 - amplitudes.iter().sum::<f64>());
    std::iter::once(0.0)
        .chain(delays)
        .zip(amplitudes)
        .map(|(t, a)| [t, a])
        .collect()
}

/// Marlin's `M593` for an axis: `Stepper::set_shaping_damping_ratio` and `set_shaping_frequency`, with a timer of 2 MHz.
pub(crate) fn m593(text: &str, axis: char) -> Impulses {
    let given = parameters(command(text, &format!("M593 {axis}")));
    let frequency: f64 = given[&'F'].parse().unwrap();
    if frequency == 0.0 {
        return vec![[0.0, 1.0]];
    }
    let zeta: f64 = given[&'D'].parse().unwrap();
    assert!((0.0..=1.0).contains(&zeta));
    let mut factor = 64.0;
    if zeta > 0.0 {
        factor = 64.44056192 - 99.02008832 * zeta - 7.58095488 * zeta.powi(2) + 43.073216 * zeta.powi(3);
    }
    let factor = factor.floor();
    let delay = (1e6 / frequency).floor() / 2e6;
    vec![[0.0, (128.0 - factor) / 128.0], [delay, factor / 128.0]]
}

/// Marlin's fixed-time motion for an axis: `M493` version 2 (axis flags) or 1, `set_axis_shaping_A` and `set_axis_shaping_N` with samples of 1 ms.
pub(crate) fn m493(text: &str, axis: char, version: u32) -> Impulses {
    assert_eq!(command(text, "M493 S"), "M493 S1");
    let given = parameters(command(text, &format!("M493 {axis}")));
    let letters = match (version, axis) {
        (1, 'Y') => ['B', 'J', 'R'],
        _ => ['A', 'I', 'Q'],
    };
    let kind: u8 = given[&if version == 1 { axis } else { 'C' }].parse().unwrap();
    if kind == 0 {
        return vec![[0.0, 1.0]];
    }
    let number = |letter: char| -> f64 { given[&letter].parse().unwrap() };
    let (f, zeta) = (number(letters[0]), number(letters[1]));
    assert!((20.0..=500.0).contains(&f) && (0.01..=0.25).contains(&zeta));
    let df = (1.0 - zeta * zeta).sqrt();
    let k = (-zeta * PI / df).exp();
    let tolerance = || number(letters[2]);
    let mut a = match kind {
        1 => vec![1.0, k],
        2 => vec![1.0, 2.0 * k, k * k],
        3 => vec![1.0, 3.0 * k, 3.0 * k * k, k * k * k],
        4 => vec![1.0, 4.0 * k, 6.0 * k * k, 4.0 * k.powi(3), k.powi(4)],
        5 => {
            let v = tolerance();
            vec![0.25 * (1.0 + v), 0.5 * (1.0 - v) * k, 0.25 * (1.0 + v) * k * k]
        }
        6 => {
            let v2 = tolerance().powi(2);
            let x = (v2 * ((1.0 - v2).sqrt() + 1.0)).powf(1.0 / 3.0);
            let first = (3.0 * x * x + 2.0 * x + 3.0 * v2) / (16.0 * x);
            let second = (0.5 - first) * k;
            vec![first, second, second * k, first * k.powi(3)]
        }
        7 => {
            let v = tolerance();
            let first = 0.0625 * (1.0 + 3.0 * v + 2.0 * (2.0 * (v + 1.0) * v).sqrt());
            let second = 0.25 * (1.0 - v) * k;
            let third = (0.5 * (1.0 + v) - 2.0 * first) * k * k;
            vec![first, second, third, second * k * k, first * k.powi(4)]
        }
        8 => vec![1.0, 2.0f64.sqrt() * k, k * k],
        _ => panic!("compensator {kind}"),
    };
    assert_eq!(
        given.contains_key(&letters[2]),
        (5..=7).contains(&kind),
        "Q of EI kinds only"
    );
    let sum: f64 = a.iter().sum();
    a.iter_mut().for_each(|a| *a /= sum);
    let base = if kind == 8 { 0.375 } else { 0.5 };
    let samples = (base / f / df * 1000.0).round();
    a.into_iter()
        .enumerate()
        .map(|(i, a)| [i as f64 * samples / 1000.0, a])
        .collect()
}

/// A table of axis, time and amplitude with a separator; lines that begin with # are comments, `head` lines are names.
pub(crate) fn table(text: &str, separator: char, head: usize) -> Vec<(String, [f64; 2])> {
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .skip(head)
        .map(|line| {
            let cells: Vec<&str> = line.split(separator).collect();
            assert_eq!(cells.len(), 3, "{line}");
            (
                cells[0].to_owned(),
                [cells[1].parse().unwrap(), cells[2].parse().unwrap()],
            )
        })
        .collect()
}

/// MATLAB's assignments `name.field.field = [row];`.
pub(crate) fn matlab(text: &str) -> HashMap<String, Vec<f64>> {
    text.lines()
        .map(|line| line.split('%').next().unwrap().trim())
        .filter(|line| !line.is_empty())
        .map(|line| {
            let (name, row) = line
                .strip_suffix("];")
                .and_then(|line| line.split_once(" = ["))
                .unwrap();
            assert!(
                name.split('.')
                    .all(|part| part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'))
            );
            (
                name.to_owned(),
                row.split_whitespace().map(|n| n.parse().unwrap()).collect(),
            )
        })
        .collect()
}
