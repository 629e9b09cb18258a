//! One line of a paper's table, and how it ends.

use std::fmt;

/// How a row ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PaperVerdict {
    /// The paper's number is ours, to its printed digits.
    Reproduced,
    /// The paper's number is wrong; the reason says why.
    Erratum,
    /// There is nothing to hold against the paper's number; the reason says why.
    NotComparable,
    /// A fault of posicast: the row was agreed on as another, and is not that any more.
    NotReproduced,
}

impl fmt::Display for PaperVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            PaperVerdict::Reproduced => "reproduced",
            PaperVerdict::Erratum => "erratum",
            PaperVerdict::NotComparable => "not comparable",
            PaperVerdict::NotReproduced => "not reproduced",
        })
    }
}

/// One or more numbers, or a statement.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// Numbers that belong together.
    Numbers(Vec<f64>),
    /// A statement.
    Text(String),
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Value::Number(number)
    }
}

impl From<Vec<f64>> for Value {
    fn from(numbers: Vec<f64>) -> Self {
        Value::Numbers(numbers)
    }
}

impl<const N: usize> From<[f64; N]> for Value {
    fn from(numbers: [f64; N]) -> Self {
        Value::Numbers(numbers.to_vec())
    }
}

/// One line of a paper's table.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperRow {
    /// Where in the paper, and what.
    pub item: String,
    /// The paper's numbers.
    pub paper: Value,
    /// The paper's numbers as they are printed.
    pub printed: String,
    /// Ours; `None` if there is nothing to compare with.
    pub ours: Option<Value>,
    /// The verdict.
    pub verdict: PaperVerdict,
    /// Why it is an erratum or not comparable, or what the agreement rests on; empty where there is nothing to say.
    pub reason: String,
}

impl PaperRow {
    /// Largest difference, ours minus the paper's; `None` for statements.
    pub fn difference(&self) -> Option<f64> {
        let (paper, ours) = (numbers(&self.paper), numbers(self.ours.as_ref()?));
        let differences = ours.iter().zip(&paper).map(|(ours, paper)| ours - paper);
        differences.reduce(|a, b| if a.abs() >= b.abs() { a } else { b })
    }
}

/// The numbers of a value, none of a statement.
pub(super) fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(number) => vec![*number],
        Value::Numbers(numbers) => numbers.clone(),
        Value::Text(_) => Vec::new(),
    }
}
