//! Keys that a table of this kind does not have, and keys that are missing: often one and the same, misspelt.

use std::fmt::Display;

use super::Table;
use crate::machine_file::error::ProblemCause;
use crate::machine_file::key::{Key, Values};
use crate::machine_file::machine;
use crate::spelling::{did_you_mean, nearest};

impl Table<'_, '_> {
    /// Refuses every key that is not in the list. Where an unknown key is most likely a misspelling of a listed one,
    /// the listed one is not reported as missing afterwards.
    pub(in crate::machine_file) fn allow(&self, keys: &[Key]) {
        let keys: Vec<&'static str> = keys.iter().map(|key| key.name).collect();
        let unknown = self
            .entries
            .keys()
            .filter(|key| !keys.contains(&key.get_ref().as_ref()));
        for key in unknown {
            let near = nearest(key.get_ref(), &keys);
            self.misspelt.borrow_mut().extend(near);
            let remedy = match (did_you_mean(key.get_ref(), &keys, '`'), home_of(key.get_ref())) {
                (Some(question), _) => format!("{question} Else remove the key"),
                (None, Some(home)) => format!("move it to {home}, which it belongs to"),
                (None, None) => "remove the key, or move it to the table that it belongs to".to_owned(),
            };
            let found = self.reader.quote(key.span());
            let cause = ProblemCause::UnknownKey {
                found: found.clone(),
                allowed: keys.join(", "),
            };
            let dotted = self.dotted(&found);
            let problem = self.reader.problem(key.span(), dotted, &self.place, cause, remedy);
            self.reader.report(problem);
        }
    }

    /// Returns whether the key is absent and was not found under a misspelt name, which has been reported already.
    pub(in crate::machine_file) fn lacks(&self, key: &str) -> bool {
        !self.has(key) && !self.misspelt.borrow().contains(&key)
    }

    /// Records a missing key where the key is absent.
    pub(in crate::machine_file) fn require(&self, key: &str, allowed: impl Display) {
        self.require_with(key, allowed, format!("add `{key}`"));
    }

    /// Records a missing key, as [`Table::require`] does, with its own remedy.
    pub(in crate::machine_file) fn require_with(&self, key: &str, allowed: impl Display, remedy: impl Into<String>) {
        if self.lacks(key) {
            let allowed = allowed.to_string();
            self.report(key, ProblemCause::MissingKey { allowed }, remedy);
        }
    }
}

/// Header of the table that has a key of this name, if there is exactly one.
fn home_of(name: &str) -> Option<String> {
    let mut homes = Vec::new();
    collect(machine::KEYS, "", name, &mut homes);
    match homes.as_slice() {
        [home] => Some(home.clone()),
        _ => None,
    }
}

fn collect(keys: &[Key], path: &str, name: &str, homes: &mut Vec<String>) {
    for key in keys {
        let dotted = match path {
            "" => key.name.to_owned(),
            path => format!("{path}.{}", key.name),
        };
        let (inner, header) = match key.values {
            Values::Table(inner) => (inner, format!("[{dotted}]")),
            Values::Tables(inner, _) => (inner, format!("[[{dotted}]]")),
            _ => continue,
        };
        if inner
            .iter()
            .any(|key| key.name == name && !matches!(key.values, Values::Table(_) | Values::Tables(..)))
        {
            homes.push(header);
        }
        collect(inner, &dotted, name, homes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_that_only_one_table_has_is_traced_to_it() {
        assert_eq!(home_of("dead_time_s").as_deref(), Some("[axis.pwm]"));
        assert_eq!(home_of("damping").as_deref(), Some("[[axis.mode]]"));
        assert_eq!(home_of("frequency_hz"), None);
        assert_eq!(home_of("wibble"), None);
    }
}
