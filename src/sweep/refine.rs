//! Refinement: a sweep that falls short by more than the tolerance is repeated with finer sampling.
//!
//! Parts thinner than their sampling error lose less with finer sampling, and curves that the
//! sampling left beside the region come nearer to it.

use super::ErrorBound;

/// Most times that a sweep that falls short by more than the tolerance is repeated with twice as
/// fine sampling.
const MOST_REFINEMENTS: usize = 4;

/// A sweep at one tolerance.
pub(super) struct Attempt<T> {
    pub(super) found: T,
    pub(super) error_bound: ErrorBound,
    /// Whether finer sampling can lower the shortfall.
    pub(super) reducible: bool,
}

/// The attempt that falls least short.
pub(super) struct Refined<T> {
    pub(super) found: T,
    pub(super) error_bound: ErrorBound,
    /// Total number of attempts.
    pub(super) attempts: usize,
}

/// Repeats until the shortfall is within a target, until finer sampling does not help or asks
/// for too much, or until it was refined often enough.
///
/// - `target`: the tolerance, or what a motion that deviates leaves within reach.
/// - `smallest`: the smallest tolerance that can be used.
/// - `attempt`: the sweep at a tolerance.
/// - `is_final`: whether an error of a finer attempt is an error of the whole. Any other means that
///   the attempt asks for too much.
///
/// # Errors
/// That of the first attempt, or one that is final.
pub(super) fn refined<T, E>(
    tolerance: f64,
    target: f64,
    smallest: f64,
    mut attempt: impl FnMut(f64) -> Result<Attempt<T>, E>,
    is_final: impl Fn(&E) -> bool,
) -> Result<Refined<T>, E> {
    let mut best = attempt(tolerance)?;
    let (mut attempts, mut finer) = (1, tolerance);
    for _ in 0..MOST_REFINEMENTS {
        finer *= 0.5;
        let is_met = best.error_bound.inside.length <= target;
        if is_met || !best.reducible || finer < smallest {
            break;
        }
        attempts += 1;
        match attempt(finer) {
            Ok(next) if next.error_bound.inside.length < best.error_bound.inside.length => {
                best = next;
            }
            Ok(_) => {}
            Err(error) if is_final(&error) => return Err(error),
            Err(_) => break,
        }
    }
    Ok(Refined {
        found: best.found,
        error_bound: best.error_bound,
        attempts,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Bound;

    /// The outcome of attempts that fall short as listed, one after the other; -1 stands for an
    /// error.
    fn tried(tolerance: f64, smallest: f64, shortfalls: &[f64]) -> Result<(f64, usize), f64> {
        let mut left = shortfalls.iter();
        let attempt = |at: f64| {
            let length = *left.next().expect("tried as often as listed");
            let bound = Bound {
                length,
                proven: true,
            };
            if length < 0.0 {
                return Err(at);
            }
            Ok(Attempt {
                found: at,
                error_bound: ErrorBound {
                    inside: bound,
                    outside: bound,
                },
                reducible: length != 7.0,
            })
        };
        let refined = refined(tolerance, tolerance, smallest, attempt, |&at| at == 0.25);
        assert!(left.next().is_none(), "tried as often as listed");
        refined.map(|refined| (refined.found, refined.attempts))
    }

    #[test]
    fn it_is_tried_until_it_is_met() {
        assert_eq!(tried(1.0, 0.0, &[1.0]), Ok((1.0, 1)), "at once");
        assert_eq!(tried(1.0, 0.0, &[3.0, 2.0, 0.5]), Ok((0.25, 3)));
        let falling = [9.0, 8.0, 6.0, 5.0, 4.0];
        assert_eq!(tried(1.0, 0.0, &falling), Ok((0.0625, 5)), "often enough");
    }

    #[test]
    fn the_best_attempt_counts() {
        let attempts = [3.0, 2.0, 4.0, 2.0, 3.0];
        assert_eq!(tried(1.0, 0.0, &attempts), Ok((0.5, 5)));
    }

    #[test]
    fn it_ends_where_nothing_is_gained() {
        assert_eq!(tried(1.0, 0.0, &[7.0]), Ok((1.0, 1)), "not reducible");
        assert_eq!(tried(1.0, 0.5, &[3.0, 2.0]), Ok((0.5, 2)), "rounding");
        assert_eq!(tried(1.0, 0.0, &[3.0, -1.0]), Ok((1.0, 2)), "too much");
    }

    #[test]
    fn an_error_of_the_whole_is_passed_on() {
        assert_eq!(tried(1.0, 0.0, &[-1.0]), Err(1.0), "of the first attempt");
        assert_eq!(tried(1.0, 0.0, &[3.0, 2.0, -1.0]), Err(0.25), "final");
    }
}
