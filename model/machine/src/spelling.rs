//! Finds the word that a user most likely meant, for messages about an unknown word.
//!
//! ```text
//! zdv ─► zvd          two letters exchanged are one change, as are a letter too many, too few and another
//! ZVD, zv_d ─► zvd    case and separators do not count
//! max_velocity ─► velocity
//! freq ─► frequency_hz, where that is allowed: words of the trade
//! ```
//!
//! ```
//! use posicast_machine::spelling::nearest;
//! assert_eq!(nearest("zdv", &["zv", "zvd"]), ["zvd"]);
//! assert_eq!(nearest("cyclone", &["cyclone2", "cyclone5", "max10"]), ["cyclone2", "cyclone5"]);
//! assert!(nearest("wibble", &["zv", "zvd"]).is_empty());
//! ```

/// Longest word that is compared, in letters.
const MAX_LETTERS: usize = 64;
/// Largest number of words that a message proposes; more would not help.
const MAX_PROPOSALS: usize = 3;
/// Shortest word, in letters, that is looked for inside another.
const MIN_PART: usize = 4;

/// Words that people use, each with the machine file's word: in small letters, without separators.
const SYNONYMS: &[(&str, &str)] = &[
    ("clock", "frequency_hz"),
    ("clockhz", "frequency_hz"),
    ("current", "torque"),
    ("cycloneii", "cyclone2"),
    ("cycloneive", "cyclone4e"),
    ("cyclonev", "cyclone5"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("force", "torque"),
    ("freq", "frequency_hz"),
    ("freqhz", "frequency_hz"),
    ("kd", "derivative"),
    ("ki", "integral"),
    ("kp", "proportional"),
    ("meter", "m"),
    ("meters", "m"),
    ("metre", "m"),
    ("metres", "m"),
    ("micrometer", "um"),
    ("micrometre", "um"),
    ("micron", "um"),
    ("microns", "um"),
    ("millimeter", "mm"),
    ("millimeters", "mm"),
    ("millimetre", "mm"),
    ("millimetres", "mm"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("revolution", "rev"),
    ("revolutions", "rev"),
    ("samplerate", "sample_hz"),
    ("samplingrate", "sample_hz"),
    ("smc", "sliding-mode"),
    ("speed", "velocity"),
    ("turn", "rev"),
    ("turns", "rev"),
    ("type", "kind"),
    ("xi", "damping"),
    ("zeta", "damping"),
    ("°", "deg"),
    ("µm", "um"),
    ("μm", "um"),
];

/// The allowed words that `found` is most likely a misspelling of: none, one, or a few that are equally near. At most
/// one letter in three may differ, and none in words of one or two letters.
pub fn nearest<'w>(found: &str, allowed: &[&'w str]) -> Vec<&'w str> {
    if found.chars().count() > MAX_LETTERS {
        return Vec::new();
    }
    let found = letters(found);
    let text: String = found.iter().collect();
    let synonyms = SYNONYMS.iter().filter(|(said, _)| *said == text);
    let meant: Vec<&str> = synonyms
        .filter_map(|(_, word)| allowed.iter().find(|a| *a == word).copied())
        .collect();
    if !meant.is_empty() {
        return meant;
    }
    let near: Vec<((usize, usize), &str)> = allowed
        .iter()
        .filter_map(|word| Some((distance(&found, &letters(word))?, *word)))
        .collect();
    let best = near.iter().map(|(distance, _)| *distance).min();
    let mut nearest: Vec<&str> = near
        .iter()
        .filter(|(d, _)| Some(*d) == best)
        .map(|(_, word)| *word)
        .collect();
    if nearest.is_empty() {
        nearest = allowed
            .iter()
            .filter(|word| holds(&found, &letters(word)))
            .copied()
            .collect();
    }
    match nearest.len() {
        0..=MAX_PROPOSALS => nearest,
        _ => Vec::new(),
    }
}

/// The question that a message asks: "did you mean `a` or `b`?", each word between `quote`s; `None` where no word is
/// near.
pub fn did_you_mean(found: &str, allowed: &[&str], quote: char) -> Option<String> {
    let words: Vec<String> = nearest(found, allowed)
        .iter()
        .map(|word| format!("{quote}{word}{quote}"))
        .collect();
    if words.is_empty() {
        None
    } else {
        Some(format!("did you mean {}?", words.join(" or ")))
    }
}

/// The remedy for a word that is not among the `allowed` ones: the nearest of them, if one is near, and the list.
pub fn choose_from(found: &str, allowed: &[&str]) -> String {
    let near = did_you_mean(found, allowed, '`').map_or_else(String::new, |question| format!("{question} Else "));
    format!("{near}choose from: {}", allowed.join(", "))
}

/// Whether two words differ only in case and separators.
pub fn same_letters(one: &str, other: &str) -> bool {
    letters(one) == letters(other)
}

fn letters(word: &str) -> Vec<char> {
    let plain = word.chars().filter(|c| !matches!(c, '-' | '_' | ' ' | '.'));
    plain.flat_map(char::to_lowercase).collect()
}

/// Number of edits and difference in length, where the edits are few enough for the word.
fn distance(found: &[char], word: &[char]) -> Option<(usize, usize)> {
    let most = if word.len() <= 2 { 0 } else { word.len().div_ceil(3) };
    let changes = edits(found, word);
    (changes <= most).then(|| (changes, found.len().abs_diff(word.len())))
}

fn holds(found: &[char], word: &[char]) -> bool {
    let inside = |part: &[char], whole: &[char]| {
        part.len() >= MIN_PART && whole.windows(part.len()).any(|window| window == part)
    };
    inside(word, found) || inside(found, word)
}

/// Number of edits: inserted, deleted or replaced letters, or exchanges of neighbours (optimal string alignment).
fn edits(from: &[char], to: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    for i in 1..=from.len() {
        let mut row = vec![i];
        for j in 1..=to.len() {
            let replaced = last[j - 1] + usize::from(from[i - 1] != to[j - 1]);
            let mut least = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1] {
                least = least.min(before[j - 2] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [&str; 7] = ["zv", "zvd", "zvdd", "ei", "two-hump-ei", "zvd-ei", "vibrationless"];

    #[test]
    fn kinds_are_found_behind_typing_errors() {
        for (found, meant) in [
            ("zdv", "zvd"),
            ("ZVD", "zvd"),
            ("Zv", "zv"),
            ("zv_d", "zvd"),
            ("two_hump_ei", "two-hump-ei"),
            ("twohumpei", "two-hump-ei"),
            ("vibrationles", "vibrationless"),
            ("EI", "ei"),
        ] {
            assert_eq!(nearest(found, &KINDS), [meant], "{found}");
        }
        assert!(nearest("wibble", &KINDS).is_empty());
        assert!(nearest("", &KINDS).is_empty());
        assert!(nearest(&"vibrationless".repeat(1000), &KINDS).is_empty());
    }

    #[test]
    fn keys_are_found_behind_typing_errors_parts_and_words_of_the_trade() {
        let keys = ["frequency_hz", "damping", "shaper", "velocity", "sample_hz"];
        for (found, meant) in [
            ("dampng", "damping"),
            ("frequenzy", "frequency_hz"),
            ("freqency_hz", "frequency_hz"),
            ("freq", "frequency_hz"),
            ("damping_ratio", "damping"),
            ("max_velocity", "velocity"),
            ("zeta", "damping"),
            ("sample_rate", "sample_hz"),
        ] {
            assert_eq!(nearest(found, &keys), [meant], "{found}");
        }
    }

    #[test]
    fn short_words_are_not_guessed_and_equally_near_ones_are_all_named() {
        assert_eq!(nearest("MM", &["m", "mm", "um"]), ["mm"]);
        assert_eq!(nearest("millimeter", &["m", "mm", "um"]), ["mm"]);
        assert!(nearest("cm", &["m", "mm", "um"]).is_empty());
        let families = ["cyclone2", "cyclone4e", "cyclone5", "max10"];
        assert_eq!(
            did_you_mean("cyclone3", &families, '"').as_deref(),
            Some("did you mean \"cyclone2\" or \"cyclone5\"?")
        );
    }

    #[test]
    fn an_exchange_of_two_letters_is_one_change() {
        let edits = |from: &str, to: &str| edits(&letters(from), &letters(to));
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("zdv", "zvd"), 1);
        assert_eq!(edits("", "zvd"), 3);
        assert_eq!(edits("zvd", ""), 3);
    }
}
