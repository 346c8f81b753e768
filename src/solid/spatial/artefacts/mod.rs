//! Artefacts of the sampling, which the exact sweep does not have: cavities (`pockets`), handles
//! (`handles`, by `loops`) and loose pieces (`islands`). They are found by their size and by
//! comparison with the exact sweep, and are filled, cut, or dropped.

pub(super) mod handles;
pub(super) mod islands;
mod loops;
pub(super) mod pockets;
