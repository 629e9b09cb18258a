//! Puts a counter beside each term of a condition: was it true, and was it false, while it decided?
//!
//! ```text
//! if (ready & (start | again)) begin   ─►   ready: (start | again) & ready, (start | again) & !ready
//!                                           start: ready & !again & start, ready & !again & !start
//!                                           again: ready & !start & again, ready & !start & !again
//! ```
//!
//! This is masking MC/DC. Conditions are those of `if` and of `? :`, and what a net of one bit is assigned. A term is what is left when
//! `&`, `|`, `&&`, `||`, `!` and `~` are taken apart: a net, a bit, a comparison. Points are counted at the clock's edge.
//!
//! Limits: the labels of a `case` are lines, not conditions. In a module without a clock, a point may be counted between two edges. A block
//! on one line (`always @(posedge clk) x <= ..;`), what follows it up to the end of the next block, and a net that is assigned where it is
//! declared (`wire x = ..;`) have no points: register banks are written so.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use posicast_hdl::emit::Module;

/// Prefix of the nets that are added.
const PREFIX: &str = "condition_";

/// The construct that encloses a statement of a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Outside of blocks: an `assign`.
    Module,
    /// `always @(*)`, whose points are sampled at the next edge.
    Combinational,
    /// `always @(posedge clk)`.
    Sequential,
}

/// A condition, with the earlier conditions that must be false for it to be evaluated.
struct Condition {
    before: Vec<String>,
    text: String,
}

/// Returns the module with a `cover` statement for each point; the comment at the end of its line describes the point.
pub(super) fn with_points(module: &Module) -> Module {
    let lines: Vec<&str> = module.text.lines().collect();
    let bits = single_bits(&lines);
    let mut points = Points {
        clocked: lines
            .iter()
            .any(|line| line.trim_start().starts_with("input  wire") && line.contains(" clk,")),
        ..Points::default()
    };
    let (mut text, mut block) = (String::new(), String::new());
    let mut place = Place::Module;
    for (at, line) in lines.iter().enumerate() {
        let words = line.trim_start();
        if words.starts_with("always @(posedge clk)") {
            place = Place::Sequential;
        } else if words.starts_with("always @") {
            place = Place::Combinational;
        }
        let conditions = match words.starts_with("always @") {
            true => Vec::new(),
            false => conditions(&lines[at..], place, &bits),
        };
        for condition in conditions {
            for (point, described) in decided(&condition) {
                points.add(place, &mut block, &point, &described);
            }
        }
        block += line;
        block.push('\n');
        // The points of an `assign` on several lines are sampled behind its last one.
        let ends = line.split("//").next().unwrap_or("").trim_end().ends_with(';');
        let is_over = match place {
            Place::Module => points.sampled.is_empty() || ends,
            _ => *line == "    end",
        };
        if is_over {
            text += &points.around(&block);
            block.clear();
            place = Place::Module;
        }
    }
    Module {
        text: text + &block,
        ..module.clone()
    }
}

/// The points of the statement or block under way.
#[derive(Debug, Default)]
struct Points {
    clocked: bool,
    number: usize,
    /// Nets of the points, and their descriptions.
    sampled: Vec<(String, String)>,
    /// Whether the nets are assigned in the block instead of at their declaration.
    in_block: bool,
}

impl Points {
    fn add(&mut self, place: Place, block: &mut String, point: &str, described: &str) {
        // Writing to a `String` cannot fail.
        if place == Place::Sequential {
            let _ = writeln!(block, "        cover ({point}); // {described}");
            return;
        }
        self.number += 1;
        let net = format!("{PREFIX}{}", self.number);
        self.in_block = place == Place::Combinational;
        let _ = match self.in_block {
            true => writeln!(block, "            {net} = {point};"),
            false => writeln!(block, "    wire {net} = {point};"),
        };
        self.sampled.push((net, described.to_owned()));
    }

    /// The text of a statement or block with its points: declarations before it, samples after it.
    fn around(&mut self, block: &str) -> String {
        let sampled = std::mem::take(&mut self.sampled);
        let mut text = String::new();
        if self.in_block && !sampled.is_empty() {
            let (first, rest) = block.split_once('\n').unwrap_or((block, ""));
            for (net, _) in &sampled {
                let _ = writeln!(text, "    reg {net};");
            }
            let _ = writeln!(text, "{first}");
            for (net, _) in &sampled {
                let _ = writeln!(text, "        {net} = 1'b0;");
            }
            text += rest;
        } else {
            text += block;
        }
        let edge = if self.clocked { "@(posedge clk)" } else { "@(*)" };
        for (net, described) in &sampled {
            let _ = writeln!(text, "    always {edge} cover ({net}); // {described}");
        }
        text
    }
}

/// The nets of one bit.
fn single_bits(lines: &[&str]) -> BTreeSet<String> {
    let mut bits = BTreeSet::new();
    for line in lines {
        let mut words = line.split("//").next().unwrap_or("").split_whitespace().peekable();
        let mut is_net = false;
        while words
            .next_if(|word| matches!(*word, "input" | "output" | "wire" | "reg"))
            .is_some()
        {
            is_net = true;
        }
        if let Some(name) = words.next().filter(|name| is_net && !name.starts_with(['[', '('])) {
            bits.insert(name.trim_end_matches([',', ';']).to_owned());
        }
    }
    bits
}

/// The conditions of the statement that begins in the first of these lines.
fn conditions(lines: &[&str], place: Place, bits: &BTreeSet<String>) -> Vec<Condition> {
    let line = lines[0];
    let words = line.trim_start();
    let one = |text: String| {
        vec![Condition {
            before: Vec::new(),
            text,
        }]
    };
    if place != Place::Module && words.starts_with("if (") {
        return chain(lines);
    }
    let statement = match place {
        Place::Module => match words.strip_prefix("assign ") {
            Some(statement) => joined(statement, &lines[1..]),
            None => return Vec::new(),
        },
        _ => joined(words, &lines[1..]),
    };
    let Some((name, value)) = statement.split_once('=') else {
        return Vec::new();
    };
    let value = value.trim().trim_end_matches(';').trim();
    let name = name.trim_end_matches('<').trim();
    let is_name = !name.is_empty() && name.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
    match (is_name, bits.contains(name), choice(value)) {
        (true, true, _) => one(value.to_owned()),
        (true, false, Some([condition, ..])) => one(condition.to_owned()),
        _ => Vec::new(),
    }
}

/// A statement on several lines as one, without comments.
fn joined(first: &str, more: &[&str]) -> String {
    let mut statement = String::new();
    for line in std::iter::once(&first).chain(more) {
        let line = line.split("//").next().unwrap_or("").trim();
        statement += line;
        if line.ends_with(';') || line.ends_with("begin") {
            break;
        }
        statement.push(' ');
    }
    statement
}

/// The conditions of an `if` and of each `else if` at its depth, each with those before it.
fn chain(lines: &[&str]) -> Vec<Condition> {
    let depth = |line: &str| line.len() - line.trim_start().len();
    let own = depth(lines[0]);
    let mut conditions: Vec<Condition> = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let words = line.trim_start();
        let goes_on = words.starts_with("end else if (") || words.starts_with("else if (");
        if at > 0 && depth(line) <= own && !goes_on {
            break;
        }
        if at > 0 && (depth(line) != own || !goes_on) {
            continue;
        }
        let statement = joined(words, &lines[at + 1..]);
        let Some(text) = statement
            .find("if (")
            .and_then(|begin| parenthesised(&statement[begin + 3..]))
        else {
            break;
        };
        let before = conditions.iter().map(|one| one.text.clone()).collect();
        let text = text.to_owned();
        conditions.push(Condition { before, text });
    }
    conditions
}

/// Returns the text between the parentheses at the start of `text`.
fn parenthesised(text: &str) -> Option<&str> {
    let mut depth = 0;
    for (at, letter) in text.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' if depth == 1 => return text.get(1..at),
            ')' => depth -= 1,
            _ => {}
        }
    }
    None
}

/// The points of a condition, each with its description.
fn decided(condition: &Condition) -> Vec<(String, String)> {
    let mut context: Vec<String> = condition.before.iter().map(|text| format!("!({text})")).collect();
    let mut points = Vec::new();
    terms(condition.text.trim(), &mut context, &mut |context, term| {
        for (value, sign) in [(1, ""), (0, "!")] {
            let mut all: Vec<String> = context.to_vec();
            all.push(format!("{sign}({term})"));
            let described = format!("{term} = {value} in {}", condition.text);
            points.push((all.join(" && "), described));
        }
    });
    points
}

/// Calls `found` for each term, with what must hold so that the term decides.
fn terms(text: &str, context: &mut Vec<String>, found: &mut dyn FnMut(&[String], &str)) {
    let text = text.trim();
    if let Some(inside) = in_parentheses(text) {
        return terms(inside, context, found);
    }
    let (operands, sign) = match operands(text) {
        Parts::Not(inside) => return terms(inside, context, found),
        Parts::Term if is_constant(text) => return,
        Parts::Term => return found(context, text),
        Parts::Choice([condition, one, other]) => {
            terms(condition, context, found);
            for (sign, branch) in [("", one), ("!", other)] {
                context.push(format!("{sign}({condition})"));
                terms(branch, context, found);
                context.pop();
            }
            return;
        }
        Parts::All(operands) => (operands, ""),
        Parts::Any(operands) => (operands, "!"),
    };
    for (at, operand) in operands.iter().enumerate() {
        let others = operands.iter().enumerate().filter(|(other, _)| *other != at);
        let length = context.len();
        context.extend(others.map(|(_, other)| format!("{sign}({other})")));
        terms(operand, context, found);
        context.truncate(length);
    }
}

/// An expression taken apart at its weakest operator.
enum Parts<'a> {
    All(Vec<&'a str>),
    Any(Vec<&'a str>),
    Not(&'a str),
    Choice([&'a str; 3]),
    Term,
}

fn operands(text: &str) -> Parts<'_> {
    if let Some(parts) = choice(text) {
        return Parts::Choice(parts);
    }
    let split = |operator| Some(split(text, operator)).filter(|parts| parts.len() > 1);
    if let Some(parts) = split("||") {
        return Parts::Any(parts);
    }
    if let Some(parts) = split("&&") {
        return Parts::All(parts);
    }
    if let Some(parts) = split("|") {
        return Parts::Any(parts);
    }
    if split("^").is_some() {
        return Parts::Term;
    }
    if let Some(parts) = split("&") {
        return Parts::All(parts);
    }
    let inside = text.strip_prefix(['!', '~']).map(str::trim_start);
    match inside.filter(|inside| is_operand(inside)) {
        Some(inside) => Parts::Not(inside),
        None => Parts::Term,
    }
}

/// Whether a text is one operand: a net, a bit, or something in parentheses.
fn is_operand(text: &str) -> bool {
    let is_letter = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '[' | ']');
    in_parentheses(text).is_some() || text.chars().all(is_letter)
}

/// Returns the text between parentheses that enclose all of `text`; `None` if none do.
fn in_parentheses(text: &str) -> Option<&str> {
    let inside = parenthesised(text).filter(|_| text.starts_with('('))?;
    (inside.len() + 2 == text.len()).then_some(inside)
}

fn is_constant(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_digit())
}

/// The three parts of a choice `condition ? one : other`.
fn choice(text: &str) -> Option<[&str; 3]> {
    let question = outside(text).find(|(_, letter)| *letter == '?')?.0;
    let colon = outside(text).find(|(at, letter)| *letter == ':' && *at > question)?.0;
    Some([&text[..question], &text[question + 1..colon], &text[colon + 1..]].map(str::trim))
}

/// The letters outside of brackets, with their places.
fn outside(text: &str) -> impl Iterator<Item = (usize, char)> + '_ {
    let mut depth = 0;
    text.char_indices().filter(move |(_, letter)| {
        match letter {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        depth == 0
    })
}

/// Splits at an operator outside of brackets, where it stands between two operands.
fn split<'a>(text: &'a str, operator: &str) -> Vec<&'a str> {
    let letters = text.as_bytes();
    let at_letter = |at: usize| letters.get(at).copied().unwrap_or(b' ');
    let mut parts = Vec::new();
    let mut begin = 0;
    for (at, letter) in outside(text) {
        if !operator.starts_with(letter) || at < begin || !text[at..].starts_with(operator) {
            continue;
        }
        let own = operator.as_bytes()[0];
        let is_longer = operator.len() == 1 && (at_letter(at + 1) == own || at > 0 && at_letter(at - 1) == own);
        let before = text[..at].trim_end().chars().next_back();
        let is_binary =
            before.is_some_and(|before| before.is_alphanumeric() || matches!(before, '_' | ')' | ']' | '}'));
        if is_binary && !is_longer {
            parts.push(text[begin..at].trim());
            begin = at + operator.len();
        }
    }
    parts.push(text[begin..].trim());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(text: &str) -> Vec<String> {
        let condition = Condition {
            before: Vec::new(),
            text: text.to_owned(),
        };
        decided(&condition).into_iter().map(|(point, _)| point).collect()
    }

    #[test]
    fn a_term_decides_where_the_others_let_it() {
        assert_eq!(
            points("ready & (start | !again[2])"),
            [
                "(start | !again[2]) && (ready)",
                "(start | !again[2]) && !(ready)",
                "(ready) && !(!again[2]) && (start)",
                "(ready) && !(!again[2]) && !(start)",
                "(ready) && !(start) && (again[2])",
                "(ready) && !(start) && !(again[2])",
            ]
            .map(|text| text.replace("(start | !again[2]) &&", "((start | !again[2])) &&"))
        );
    }

    #[test]
    fn comparisons_and_reductions_are_terms_but_constants_are_not() {
        assert_eq!(points("(|word) & 1'd1"), ["(1'd1) && (|word)", "(1'd1) && !(|word)"]);
        assert_eq!(points("a == b"), ["(a == b)", "!(a == b)"]);
        assert_eq!(points("!(a ^ b)"), ["(a ^ b)", "!(a ^ b)"]);
        assert_eq!(points("c ? a : 1'd0"), ["(c)", "!(c)", "(c) && (a)", "(c) && !(a)"]);
    }

    #[test]
    fn an_else_if_is_evaluated_where_the_conditions_before_it_are_false() {
        let lines = [
            "        if (a) begin",
            "            x = b;",
            "        end else if (b &",
            "            c) begin",
            "        end",
        ];
        let conditions = chain(&lines);
        let shown: Vec<_> = conditions
            .iter()
            .map(|one| (one.before.clone(), one.text.as_str()))
            .collect();
        assert_eq!(shown, [(vec![], "a"), (vec!["a".to_owned()], "b & c")]);
    }
}
