//! The tables of `docs/machine-file.md`: the keys of each table of the file.
//!
//! A table of the page stands between two marks. The rows come from the keys that the reader allows; a test compares, and
//! `scripts/regenerate` writes them again.
//!
//! ```text
//! <!-- keys of [axis.limits]: generated -->
//! | key | meaning | allowed | default |
//! <!-- end -->
//! ```

use super::axis::NEEDS;
use super::key::{Default, Key, Values};
use super::machine::KEYS;
use super::range::NumberRange;

/// Longest list of words that a row repeats; a longer one is explained by [`Key::rule`].
const WORDS_MAX: usize = 8;
/// Ends of a range from here on only keep absurd numbers out.
const UNLIMITED: f64 = 1e9;

/// Returns the page with its tables renewed from the keys of this version.
///
/// # Errors
/// The mark that the page lacks.
pub fn with_tables(page: &str) -> Result<String, String> {
    let mut tables = vec![("file".to_owned(), table(KEYS, ""))];
    collect(KEYS, "", &mut tables);
    let mut page = page.to_owned();
    for (name, table) in tables {
        page = between(&page, &format!("<!-- keys of {name}: generated -->"), &table)?;
    }
    Ok(page)
}

/// Replaces what is between a mark and the next `<!-- end -->`.
fn between(page: &str, mark: &str, table: &str) -> Result<String, String> {
    let parts = page.split_once(mark).and_then(|(before, rest)| {
        let (_, after) = rest.split_once(END)?;
        Some((before, after))
    });
    let (before, after) = parts.ok_or_else(|| format!("`{mark}` and, below it, `{END}`"))?;
    Ok(format!("{before}{mark}\n\n{table}\n{END}{after}"))
}

const END: &str = "<!-- end -->";

/// The tables below `path`, each with its name and its rows.
fn collect(keys: &[Key], path: &str, found: &mut Vec<(String, String)>) {
    for key in keys {
        let path = dotted(path, key);
        let (name, inner) = match key.values {
            Values::Table(inner) => (format!("[{path}]"), inner),
            Values::Tables(inner, _) => (format!("[[{path}]]"), inner),
            _ => continue,
        };
        found.push((name, table(inner, &path)));
        collect(inner, &path, found);
    }
}

fn dotted(path: &str, key: &Key) -> String {
    match path {
        "" => key.name.to_owned(),
        path => format!("{path}.{}", key.name),
    }
}

fn table(keys: &[Key], path: &str) -> String {
    let rows = keys.iter().map(|key| {
        let cells = [name(key, path), key.about.to_owned(), allowed(key), absent(key, keys)];
        row(&cells)
    });
    head(&["key", "meaning", "allowed", "default"]) + &rows.collect::<String>()
}

fn head(titles: &[&str]) -> String {
    let titles: Vec<String> = titles.iter().map(|title| (*title).to_owned()).collect();
    row(&titles) + &"|---".repeat(titles.len()) + "|\n"
}

fn row(cells: &[String]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}

/// A key as the file writes it; a table with a link to its section.
fn name(key: &Key, path: &str) -> String {
    let path = dotted(path, key);
    let anchor = path.replace('.', "");
    match key.values {
        Values::Table(_) => format!("[`[{path}]`](#{anchor})"),
        Values::Tables(..) => format!("[`[[{path}]]`](#{anchor})"),
        _ => format!("`{}`", key.name),
    }
}

/// Returns the allowed values of a key.
fn allowed(key: &Key) -> String {
    let needs = NEEDS
        .iter()
        .filter(|need| matches!(key.values, Values::Table(_)) && need.block == key.name);
    let needs = needs.map(|need| {
        let others: Vec<String> = need.others.iter().map(|other| format!("`[axis.{other}]`")).collect();
        let or = need.or.map_or_else(String::new, |or| format!(" or `[axis.{or}]`"));
        format!("needs {}{or}", others.join(", "))
    });
    let parts = [values(key.values), key.rule.to_owned()].into_iter().chain(needs);
    let parts: Vec<String> = parts.filter(|part| !part.is_empty()).collect();
    parts.join("; ")
}

/// Returns the meaning of an absent key.
fn absent(key: &Key, keys: &[Key]) -> String {
    if let Some(default) = key.default {
        return match default {
            Default::Number(number) => number.to_string(),
            Default::Integer(number) => number.to_string(),
            Default::Boolean(flag) => flag.to_string(),
            Default::Word(word) => format!("`{word}`"),
        };
    }
    if key.required {
        return "required".to_owned();
    }
    let group = key.instead_of.unwrap_or(key.name);
    let others: Vec<String> = keys
        .iter()
        .filter(|other| other.name != key.name && (other.name == group || other.instead_of == Some(group)))
        .map(|other| format!("`{}`", other.name))
        .collect();
    match (key.needed_by, others.is_empty()) {
        (Some(other), _) => format!("required beside `{other}`"),
        (None, false) => format!("required, or {}", others.join(", ")),
        (None, true) => String::new(),
    }
}

fn values(values: Values) -> String {
    match values {
        Values::Number(range) | Values::Quantity(range) | Values::Counts(range) => interval(range),
        Values::Integer(low, high) => format!("{} to {}", grouped(low), grouped(high)),
        Values::OneOf(list) => list.iter().map(u32::to_string).collect::<Vec<_>>().join(", "),
        Values::Boolean => "true, false".to_owned(),
        Values::Name => "a name".to_owned(),
        Values::CsvName => "a name that ends in `.csv`, without a folder".to_owned(),
        Values::Word(list) => words(&list()),
        Values::Words(list) => match words(&list()).as_str() {
            "" => String::new(),
            words => format!("a list of {words}"),
        },
        Values::WordOrPair(list, range) => format!("{}, or [low, high], each {}", words(&list()), interval(range)),
        Values::PlainPair(range) | Values::Pair(range) => format!("each {}", interval(range)),
        Values::Pairs(_, most) => format!("1 to {most} pairs"),
        Values::Rows(ranges, most) => {
            let ranges: Vec<String> = ranges.iter().map(|range| interval(*range)).collect();
            format!("rows of {}; at most {most}", ranges.join("; "))
        }
        Values::Numbers(range, most) => format!("1 to {most} numbers, {}", interval(range)),
        Values::Table(_) => String::new(),
        Values::Tables(_, most) => format!("1 to {most} tables"),
    }
}

fn words(list: &[&str]) -> String {
    if list.len() > WORDS_MAX {
        String::new()
    } else {
        list.iter()
            .map(|word| format!("`{word}`"))
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// A range without its unit, which the meaning or the name has. An end that only keeps absurd numbers out is left out.
fn interval(range: NumberRange) -> String {
    let ((low, has_low), (high, has_high)) = (range.low(), range.high());
    match (low <= -UNLIMITED, has_low, high >= UNLIMITED, has_high) {
        (true, _, true, _) => "any number".to_owned(),
        (false, true, true, _) => format!("{low} or more"),
        (false, false, true, _) => format!("above {low}"),
        (_, true, false, true) => format!("{low} to {high}"),
        _ => range.unit("").to_string(),
    }
}

/// Writes a whole number with its thousands apart, from five digits on.
fn grouped(number: u32) -> String {
    let digits = number.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let groups = digits.as_bytes().rchunks(3).rev();
    groups.map(String::from_utf8_lossy).collect::<Vec<_>>().join(",")
}
