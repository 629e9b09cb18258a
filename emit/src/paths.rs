//! Resolves RustHDL's text for a place in a kernel (`bank[(i+1)]$d$next`) to the signal (`bank$3$d`).
//!
//! An index is an expression of integers and loop variables with `+ - *` and parentheses. Anything else, above all a
//! signal as index, is refused: Verilog-2001 has no array of ports or instances that a signal could select.

use super::error::EmitCause;

/// Loop variables in scope with their present values, innermost last.
pub(super) type Loops = [(String, i128)];

/// The signal that `text` names, without a final `$next`.
pub(super) fn resolve(text: &str, loops: &Loops) -> Result<String, EmitCause> {
    let wrong_index = || EmitCause::ArrayIndex(text.to_owned());
    let mut resolved = String::new();
    let mut rest = text;
    while let Some(open) = rest.find('[') {
        let close = rest.find(']').filter(|close| *close > open).ok_or_else(wrong_index)?;
        let index = evaluate(&rest[open + 1..close], loops).ok_or_else(wrong_index)?;
        resolved.push_str(&format!("{}${index}", &rest[..open]));
        rest = &rest[close + 1..];
    }
    resolved.push_str(rest);
    Ok(resolved.strip_suffix("$next").unwrap_or(&resolved).to_owned())
}

/// The value of the innermost loop variable `name`.
pub(super) fn loop_value(name: &str, loops: &Loops) -> Option<i128> {
    loops
        .iter()
        .rev()
        .find(|(variable, _)| variable == name)
        .map(|(_, value)| *value)
}

fn evaluate(text: &str, loops: &Loops) -> Option<i128> {
    let mut parser = Index { rest: text, loops };
    let value = parser.sum()?;
    (parser.rest.is_empty() && value >= 0).then_some(value)
}

/// Recursive descent over `sum = product {(+|-) product}`, `product = atom {* atom}`, `atom = number | name | (sum)`.
struct Index<'a> {
    rest: &'a str,
    loops: &'a Loops,
}

impl Index<'_> {
    fn sum(&mut self) -> Option<i128> {
        let mut value = self.product()?;
        loop {
            if self.eat("+") {
                value = value.checked_add(self.product()?)?;
            } else if self.eat("-") {
                value = value.checked_sub(self.product()?)?;
            } else {
                return Some(value);
            }
        }
    }

    fn product(&mut self) -> Option<i128> {
        let mut value = self.atom()?;
        while self.eat("*") {
            value = value.checked_mul(self.atom()?)?;
        }
        Some(value)
    }

    fn atom(&mut self) -> Option<i128> {
        if self.eat("(") {
            let value = self.sum()?;
            return self.eat(")").then_some(value);
        }
        let end = self
            .rest
            .find(|c: char| !c.is_ascii_alphanumeric() && c != '_')
            .unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        let number = word.strip_suffix("usize").unwrap_or(word).parse().ok();
        number.or_else(|| loop_value(word, self.loops))
    }

    fn eat(&mut self, token: &str) -> bool {
        match self.rest.strip_prefix(token) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_evaluated() {
        let loops = [("i".to_owned(), 2)];
        let resolved = |text| resolve(text, &loops);
        assert_eq!(resolved("count$d$next").as_deref(), Ok("count$d"));
        assert_eq!(resolved("bank[i]$d$next").as_deref(), Ok("bank$2$d"));
        assert_eq!(resolved("v[((i+1)*3-4)]").as_deref(), Ok("v$5"));
        assert_eq!(resolved("v[0usize][i]").as_deref(), Ok("v$0$2"));
        for bad in ["v[sel$val()$index()]", "v[i", "v[]", "v[(i]", "v[i-3]", "v[k]", "v]i["] {
            assert!(resolved(bad).is_err(), "{bad}");
        }
    }
}
