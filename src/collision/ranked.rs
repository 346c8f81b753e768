//! Items of a heap, ordered by their keys alone.

use std::cmp::Ordering;

/// An item of a heap, which gives the greatest key first.
pub(super) struct Ranked<K, T> {
    pub(super) key: K,
    pub(super) item: T,
}

impl<K: Ord, T> PartialEq for Ranked<K, T> {
    fn eq(&self, other: &Ranked<K, T>) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<K: Ord, T> Eq for Ranked<K, T> {}

impl<K: Ord, T> PartialOrd for Ranked<K, T> {
    fn partial_cmp(&self, other: &Ranked<K, T>) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<K: Ord, T> Ord for Ranked<K, T> {
    fn cmp(&self, other: &Ranked<K, T>) -> Ordering {
        self.key.cmp(&other.key)
    }
}
