//! Rows of a paper's table: the printed number, ours, and the verdict.
//!
//! Only the paper's own number is entered, as it is printed: its digits decide what counts as equal.
//!
//! | rule | the printed number is ours … |
//! |---|---|
//! | [`Rule::Rounded`] | rounded to the printed digits |
//! | [`Rule::Truncated`] | truncated after them |
//! | [`Rule::RoundedUp`] | rounded away from zero to them |
//! | [`Rule::Within`] | up to an absolute difference that the row states |
//! | [`Rule::AtMost`] | or more: it is a bound |
//!
//! A row is entered as one that agrees, or as an erratum with its reason. If a row entered as agreeing does not
//! agree, or if an erratum agrees after all, it becomes [`PaperVerdict::NotReproduced`]: then posicast has changed,
//! not the paper.

use super::row::{PaperRow, PaperVerdict, Value, numbers};

/// Rule for equality.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// Our number rounds to the printed digits.
    Rounded,
    /// Our number, truncated, has the printed digits.
    Truncated,
    /// Our number, rounded away from zero, has the printed digits.
    RoundedUp,
    /// Our number differs by no more than this.
    Within(f64),
    /// Our number is no more than the printed bound.
    AtMost,
}

impl Rule {
    fn holds(self, printed: &PrintedNumber, ours: f64) -> bool {
        let unit = 10f64.powi(-printed.decimals);
        // The slack keeps ties and the rounding of decimals to binary from deciding.
        let slack = 1e-9 * unit + 4.0 * f64::EPSILON * ours.abs();
        let beyond = (ours - printed.value) * if ours < 0.0 { -1.0 } else { 1.0 };
        match self {
            Rule::Rounded => (ours - printed.value).abs() <= unit / 2.0 + slack,
            Rule::Truncated => beyond >= -slack && beyond < unit,
            Rule::RoundedUp => beyond <= slack && beyond > -unit,
            Rule::Within(difference) => (ours - printed.value).abs() <= difference,
            Rule::AtMost => ours <= printed.value,
        }
    }
}

struct PrintedNumber {
    value: f64,
    /// Number of digits after the decimal point minus the exponent.
    decimals: i32,
}

impl PrintedNumber {
    /// Parses a number. A text that is not a number becomes NaN, which equals nothing.
    fn parse(text: &str) -> Self {
        let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
        let digits = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len() as i32);
        Self {
            value: text.parse().unwrap_or(f64::NAN),
            decimals: digits - exponent.parse::<i32>().unwrap_or(0),
        }
    }
}

/// Numbers as they are printed in the paper.
pub(super) struct Printed(Vec<&'static str>);

impl From<&'static str> for Printed {
    fn from(number: &'static str) -> Self {
        Printed(vec![number])
    }
}

impl<const N: usize> From<[&'static str; N]> for Printed {
    fn from(numbers: [&'static str; N]) -> Self {
        Printed(numbers.to_vec())
    }
}

impl Printed {
    fn value(&self) -> Value {
        let values = self.0.iter().map(|n| PrintedNumber::parse(n).value);
        match self.0.len() {
            1 => values.sum::<f64>().into(),
            _ => values.collect::<Vec<_>>().into(),
        }
    }

    fn text(&self) -> String {
        self.0.join(", ")
    }

    fn equals(&self, ours: &Value, rule: Rule) -> bool {
        let ours = numbers(ours);
        let mut pairs = self.0.iter().zip(&ours);
        self.0.len() == ours.len() && pairs.all(|(n, ours)| rule.holds(&PrintedNumber::parse(n), *ours))
    }
}

/// The rows of one paper while they are entered.
#[derive(Default)]
pub(super) struct Sheet {
    rows: Vec<PaperRow>,
}

impl Sheet {
    /// Returns the rows.
    pub(super) fn into_rows(self) -> Vec<PaperRow> {
        self.rows
    }

    /// Adds a number that equals ours, rounded.
    pub(super) fn equal(&mut self, item: impl Into<String>, printed: impl Into<Printed>, ours: impl Into<Value>) {
        self.by_rule(item, printed, ours, Rule::Rounded, "");
    }

    /// Adds a number that equals ours by a rule, with a remark.
    pub(super) fn by_rule(
        &mut self,
        item: impl Into<String>,
        printed: impl Into<Printed>,
        ours: impl Into<Value>,
        rule: Rule,
        note: &str,
    ) {
        let (printed, ours) = (printed.into(), ours.into());
        let verdict = if printed.equals(&ours, rule) {
            PaperVerdict::Reproduced
        } else {
            PaperVerdict::NotReproduced
        };
        self.enter(item, &printed, Some(ours), verdict, note);
    }

    /// Adds a number that is wrong in the paper.
    pub(super) fn erratum(
        &mut self,
        item: impl Into<String>,
        printed: impl Into<Printed>,
        ours: impl Into<Value>,
        reason: &str,
    ) {
        let (printed, ours) = (printed.into(), ours.into());
        let finite = numbers(&ours).iter().all(|n| n.is_finite());
        let verdict = if finite && !printed.equals(&ours, Rule::Rounded) {
            PaperVerdict::Erratum
        } else {
            PaperVerdict::NotReproduced
        };
        self.enter(item, &printed, Some(ours), verdict, reason);
    }

    /// Adds a bound of the paper that is exceeded.
    pub(super) fn exceeded(
        &mut self,
        item: impl Into<String>,
        printed: impl Into<Printed>,
        ours: impl Into<Value>,
        reason: &str,
    ) {
        let (printed, ours) = (printed.into(), ours.into());
        let verdict = if printed.equals(&ours, Rule::AtMost) {
            PaperVerdict::NotReproduced
        } else {
            PaperVerdict::Erratum
        };
        self.enter(item, &printed, Some(ours), verdict, reason);
    }

    /// Adds a number of the paper that has no counterpart.
    pub(super) fn not_comparable(&mut self, item: impl Into<String>, printed: impl Into<Printed>, reason: &str) {
        self.enter(item, &printed.into(), None, PaperVerdict::NotComparable, reason);
    }

    /// Adds numbers for which the paper has a formula, evaluated as printed. They must agree up to rounding.
    pub(super) fn formula(&mut self, item: impl Into<String>, paper: impl Into<Value>, ours: impl Into<Value>) {
        const ROUNDING: f64 = 1e-9;
        let (paper, ours) = (paper.into(), ours.into());
        let (theirs, found) = (numbers(&paper), numbers(&ours));
        let equal = theirs.len() == found.len()
            && theirs
                .iter()
                .zip(&found)
                .all(|(a, b)| (a - b).abs() <= ROUNDING * a.abs().max(1.0));
        self.rows.push(PaperRow {
            item: item.into(),
            printed: "its formula".into(),
            paper,
            ours: Some(ours),
            verdict: if equal {
                PaperVerdict::Reproduced
            } else {
                PaperVerdict::NotReproduced
            },
            reason: "the paper gives a formula; evaluated".into(),
        });
    }

    /// Adds a statement of the paper that our figures confirm, if `holds`.
    pub(super) fn claim(&mut self, item: impl Into<String>, paper: &str, ours: String, holds: bool) {
        let verdict = if holds {
            PaperVerdict::Reproduced
        } else {
            PaperVerdict::NotReproduced
        };
        self.statement(item, paper, ours, verdict, "");
    }

    /// Adds a statement of the paper that our figures refute, unless it `holds` after all.
    pub(super) fn refuted(&mut self, item: impl Into<String>, paper: &str, ours: String, holds: bool, reason: &str) {
        let verdict = if holds {
            PaperVerdict::NotReproduced
        } else {
            PaperVerdict::Erratum
        };
        self.statement(item, paper, ours, verdict, reason);
    }

    fn statement(&mut self, item: impl Into<String>, paper: &str, ours: String, verdict: PaperVerdict, reason: &str) {
        self.rows.push(PaperRow {
            item: item.into(),
            paper: Value::Text(paper.into()),
            printed: paper.into(),
            ours: Some(Value::Text(ours)),
            verdict,
            reason: reason.into(),
        });
    }

    fn enter(
        &mut self,
        item: impl Into<String>,
        printed: &Printed,
        ours: Option<Value>,
        verdict: PaperVerdict,
        reason: &str,
    ) {
        self.rows.push(PaperRow {
            item: item.into(),
            paper: printed.value(),
            printed: printed.text(),
            ours,
            verdict,
            reason: reason.into(),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(rule: Rule, printed: &'static str, ours: f64) -> bool {
        rule.holds(&PrintedNumber::parse(printed), ours)
    }

    #[test]
    fn printed_digits_decide_what_is_equal() {
        assert!(holds(Rule::Rounded, "0.1997", 0.199_749_9) && !holds(Rule::Rounded, "0.1997", 0.199_75 + 1e-9));
        assert!(holds(Rule::Rounded, "39.05", 39.045) && holds(Rule::Rounded, "-1.5", -1.549));
        assert!(holds(Rule::Rounded, "1.3029e6", 1.302_88e6) && !holds(Rule::Rounded, "1.3029e6", 1.302_98e6));
        assert!(holds(Rule::Rounded, "100", 99.9) && !holds(Rule::Rounded, "100", 100.6));
        assert!(holds(Rule::Truncated, "39.04", 39.0476) && !holds(Rule::Truncated, "39.05", 39.0476));
        assert!(holds(Rule::Truncated, "-39.04", -39.0476));
        assert!(holds(Rule::RoundedUp, "13.22", 13.215) && !holds(Rule::RoundedUp, "13.21", 13.215));
        assert!(holds(Rule::Within(0.5), "10", 9.53) && !holds(Rule::Within(0.4), "10", 9.53));
        assert!(holds(Rule::AtMost, "5", 4.7) && !holds(Rule::AtMost, "5", 5.1));
        for rule in [
            Rule::Rounded,
            Rule::Truncated,
            Rule::RoundedUp,
            Rule::Within(1.0),
            Rule::AtMost,
        ] {
            assert!(!holds(rule, "1", f64::NAN) && !holds(rule, "one", 1.0));
        }
    }

    #[test]
    fn a_changed_number_flips_its_row() {
        let verdicts = |computed: f64| {
            let mut sheet = Sheet::default();
            sheet.equal("agrees", "0.1997", computed);
            sheet.erratum("is wrong", "0.2124", computed, "misprint");
            sheet.exceeded("is a bound", "0.15", computed, "forgotten case");
            sheet.equal("array", ["0.1997", "1"], [computed, 1.0]);
            sheet.formula("formula", 0.19972, computed);
            sheet.into_rows().iter().map(|row| row.verdict).collect::<Vec<_>>()
        };
        let as_agreed = [
            PaperVerdict::Reproduced,
            PaperVerdict::Erratum,
            PaperVerdict::Erratum,
            PaperVerdict::Reproduced,
            PaperVerdict::Reproduced,
        ];
        assert_eq!(verdicts(0.19972), as_agreed);
        for changed in [0.2124, 0.1, f64::NAN] {
            let found = verdicts(changed);
            assert!(found.contains(&PaperVerdict::NotReproduced), "{changed}: {found:?}");
            assert!(!found.contains(&PaperVerdict::Reproduced), "{changed}: {found:?}");
        }
        assert_eq!(
            verdicts(0.2124)[1],
            PaperVerdict::NotReproduced,
            "an erratum that agrees"
        );
    }

    #[test]
    fn the_difference_is_the_largest_of_the_row() {
        let mut sheet = Sheet::default();
        sheet.equal("two", ["1.0", "2.0"], [1.01, 1.98]);
        let difference = sheet.into_rows()[0].difference().unwrap();
        assert!((difference + 0.02).abs() < 1e-12);
    }
}
