//! Why a motion was refused.

/// Why a motion was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A number of the motion is NaN or infinite.
    #[error("the motion has a number that is not finite")]
    NonFinite,
}
