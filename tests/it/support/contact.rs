//! First contact by a slow method, scenes that aim at trouble, and what an answer must satisfy.

pub(crate) mod agreement;
pub(crate) mod data;
pub(crate) mod distance;
pub(crate) mod entering;
pub(crate) mod exact;
pub(crate) mod families;
pub(crate) mod gaps;
pub(crate) mod pairs;
pub(crate) mod panda;
pub(crate) mod reference;
pub(crate) mod scene;

/// The value that this share of the sorted numbers does not exceed.
pub(crate) fn percentile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}
