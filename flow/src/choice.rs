//! Options that take one of a few words.

/// An option that takes one of a few words.
pub trait WordChoice: Copy + Send + Sync + 'static {
    /// Every value, in the order in which they are offered.
    const ALL: &'static [Self];

    /// The word of a value.
    fn word(self) -> &'static str;

    /// A description in a few words.
    fn about(self) -> &'static str;

    /// Returns the value of a word; `None` for any other word.
    #[must_use]
    fn of_word(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|value| value.word() == word)
    }
}
