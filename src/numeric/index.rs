//! The one narrowing of counts to the 32-bit indices that meshes use.

/// `count` as a mesh index.
///
/// # Panics
/// Above 2^32 - 1. A mesh of that size needs over 100 GB, so memory runs out before indices do.
pub(crate) fn index(count: usize) -> u32 {
    u32::try_from(count).expect("a mesh has fewer than 2^32 elements")
}
