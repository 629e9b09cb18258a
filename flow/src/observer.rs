//! Messages and progress from a step to its front.

use std::time::{Duration, Instant};

/// The front of a step. Steps call it from several threads.
pub trait Observer: Sync {
    /// A message for the user, in lines; a warning begins with `warning:`, a note with `note:`.
    fn say(&self, message: &str);

    /// A part of the work begins: `what` is its name, and `steps` the number of its steps if that is known.
    fn begin(&self, what: &str, steps: Option<u64>) -> Box<dyn WorkProgress>;

    /// A part of the work begins whose steps cannot be counted, such as a run of another program; `expected` is how long it probably takes,
    /// if that is known.
    fn begin_timed(&self, what: &str, expected: Option<ExpectedTime>) -> Box<dyn WorkProgress> {
        let _ = expected;
        self.begin(what, None)
    }
}

/// How long work probably takes, because an earlier run of the same kind took as long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExpectedTime {
    /// The part that begins.
    pub part: Duration,
    /// All that follows it.
    pub after: Duration,
}

impl ExpectedTime {
    /// The time to the end of all after the part has taken `elapsed`; `None` if it has taken longer than it should: then nothing is known.
    #[must_use]
    pub fn left(self, elapsed: Duration) -> Option<Duration> {
        let rest = self.part.checked_sub(elapsed)?;
        Some(rest + self.after)
    }
}

/// The progress of a part of the work, which ends when this is dropped.
pub trait WorkProgress: Send + Sync {
    /// This many more steps are done.
    fn advance(&self, steps: u64);

    /// This many steps are done in all.
    fn reach(&self, done: u64);

    /// The current part gets another name.
    fn rename(&self, what: &str);
}

/// A front that shows nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn say(&self, _message: &str) {}

    fn begin(&self, _what: &str, _steps: Option<u64>) -> Box<dyn WorkProgress> {
        Box::new(Self)
    }
}

impl WorkProgress for Silent {
    fn advance(&self, _steps: u64) {}

    fn reach(&self, _done: u64) {}

    fn rename(&self, _what: &str) {}
}

/// Time after which work counts as long.
const LONG: Duration = Duration::from_secs(2);

/// A part of the work that begins for the front only if it takes long.
pub struct Late<'a> {
    observer: &'a dyn Observer,
    what: &'static str,
    steps: u64,
    begun: Instant,
    shown: Option<Box<dyn WorkProgress>>,
}

impl<'a> Late<'a> {
    /// Work of this many steps.
    #[must_use]
    pub fn new(observer: &'a dyn Observer, what: &'static str, steps: u64) -> Self {
        Self {
            observer,
            what,
            steps,
            begun: Instant::now(),
            shown: None,
        }
    }

    /// This many steps are done in all.
    pub fn reach(&mut self, done: u64) {
        if self.shown.is_none() && self.begun.elapsed() >= LONG {
            self.shown = Some(self.observer.begin(self.what, Some(self.steps)));
        }
        if let Some(shown) = &self.shown {
            shown.reach(done.min(self.steps));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[derive(Default)]
    struct Noted(Mutex<Vec<String>>);

    impl Observer for Noted {
        fn say(&self, _message: &str) {}

        fn begin(&self, what: &str, steps: Option<u64>) -> Box<dyn WorkProgress> {
            if let Ok(mut noted) = self.0.lock() {
                noted.push(format!("{what}: {steps:?}"));
            }
            Box::new(Silent)
        }
    }

    #[test]
    fn the_time_left_is_that_of_the_part_and_all_that_follows() {
        let seconds = Duration::from_secs;
        let expected = ExpectedTime {
            part: seconds(60),
            after: seconds(100),
        };
        assert_eq!(expected.left(seconds(45)), Some(seconds(115)));
        assert_eq!(expected.left(seconds(61)), None);
    }

    #[test]
    fn only_work_that_takes_long_is_shown() {
        let observer = Noted::default();
        let mut late = Late::new(&observer, "reading", 10);
        late.reach(5);
        assert!(late.shown.is_none());
        late.begun -= LONG;
        late.reach(6);
        late.reach(7);
        assert_eq!(observer.0.into_inner().unwrap_or_default(), ["reading: Some(10)"]);
    }
}
