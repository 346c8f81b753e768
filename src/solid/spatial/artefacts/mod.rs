//! What the sampling made and the exact sweep has not: cavities (`pockets`), handles (`handles`, by
//! `loops`) and loose pieces (`islands`). Found by their size and by what is known of the exact
//! sweep; filled, cut, or dropped.

pub(super) mod handles;
pub(super) mod islands;
mod loops;
pub(super) mod pockets;
