//! A vector that is written in place.

/// Elements with free places behind them. Pushing each onto a vector would read and write its length in memory every
/// time, which takes longer than the rest of the work for a change.
#[derive(Debug, Default)]
pub(crate) struct Pile<T> {
    places: Vec<T>,
    count: usize,
}

impl<T: Copy + Default> Pile<T> {
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    pub(crate) fn as_slice(&self) -> &[T] {
        &self.places[..self.count]
    }

    pub(crate) fn push(&mut self, element: T) {
        self.room(1)[0] = element;
        self.count += 1;
    }

    /// Returns the places after the elements, at least `least` of them.
    #[inline]
    pub(crate) fn room(&mut self, least: usize) -> &mut [T] {
        if self.places.len() - self.count < least {
            self.places.resize(2 * (self.count + least), T::default());
        }
        &mut self.places[self.count..]
    }

    /// Counts elements that were written to the first places of the room.
    #[inline]
    pub(crate) fn grow(&mut self, by: usize) {
        self.count = (self.count + by).min(self.places.len());
    }

    #[inline]
    pub(crate) fn truncate(&mut self, count: usize) {
        self.count = self.count.min(count);
    }

    /// Keeps only the elements for which `keep` returns `true`.
    pub(crate) fn retain(&mut self, keep: impl FnMut(&T) -> bool) {
        self.places.truncate(self.count);
        self.places.retain(keep);
        self.count = self.places.len();
    }
}

impl<T> From<Vec<T>> for Pile<T> {
    fn from(places: Vec<T>) -> Self {
        let count = places.len();
        Self { places, count }
    }
}
