//! One line of a paper's table and its verdict.

use std::fmt;

/// Verdict of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PaperVerdict {
    /// The paper's number equals ours in its printed digits.
    Reproduced,
    /// The paper's number is wrong; `reason` explains why.
    Erratum,
    /// The paper's number has no counterpart; `reason` explains why.
    NotComparable,
    /// The row's verdict is no longer the one that was entered, which is a bug of posicast.
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
    /// Place in the paper and quantity.
    pub item: String,
    /// The paper's numbers.
    pub paper: Value,
    /// The paper's numbers as they are printed.
    pub printed: String,
    /// Our value; `None` if there is no counterpart.
    pub ours: Option<Value>,
    /// The verdict.
    pub verdict: PaperVerdict,
    /// Why the row is an erratum or not comparable, or what the agreement depends on; may be empty.
    pub reason: String,
}

impl PaperRow {
    /// Returns the largest difference, ours minus the paper's; `None` for statements.
    pub fn difference(&self) -> Option<f64> {
        let (paper, ours) = (numbers(&self.paper), numbers(self.ours.as_ref()?));
        let differences = ours.iter().zip(&paper).map(|(ours, paper)| ours - paper);
        differences.reduce(|a, b| if a.abs() >= b.abs() { a } else { b })
    }
}

/// Returns the numbers of a value; none for a statement.
pub(super) fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(number) => vec![*number],
        Value::Numbers(numbers) => numbers.clone(),
        Value::Text(_) => Vec::new(),
    }
}
