//! Options that take one of a few words.

/// An option that takes one of a few words.
pub trait WordChoice: Copy + Send + Sync + 'static {
    /// Every value, in the order in which they are offered.
    const ALL: &'static [Self];

    /// The word of a value.
    fn word(self) -> &'static str;

    /// What it stands for, in a few words.
    fn about(self) -> &'static str;

    /// The value of a word.
    #[must_use]
    fn of_word(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|value| value.word() == word)
    }
}
