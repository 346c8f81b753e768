//! Whether two motions commute.

use crate::motion::Generator;

/// Whether two velocity fields commute up to rounding: then the motion of one relative to the other
/// is steady too.
pub(super) fn commute(a: &Generator, b: &Generator) -> bool {
    let linear = a.linear * b.linear - b.linear * a.linear;
    let offset = a.linear * b.offset - b.linear * a.offset;
    let commutator = Generator { linear, offset };
    let sizes = [a, b].map(|g| (g.size(), g.offset.length()));
    let limit = COMMUTING * sizes[0].0 * sizes[1].0;
    let reach = COMMUTING * (sizes[0].0 * sizes[1].1 + sizes[1].0 * sizes[0].1);
    commutator.size() <= limit && commutator.offset.length() <= reach
}

/// Size of a commutator, relative to the product of the sizes of its factors, below which it is
/// rounding: each entry is a sum of six products.
pub(super) const COMMUTING: f64 = 16.0 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn turn(axis: DVec3, through: DVec3) -> Generator {
        Generator::screw(axis, through, 1.0, 0.0, 1.0)
    }

    #[test]
    fn motions_about_one_axis_commute_and_others_do_not() {
        let about = turn(DVec3::Z, DVec3::X);
        let advance = Generator::translation(DVec3::Z * 3.0);
        assert!(commute(&about, &advance), "a turn and its axis");
        assert!(commute(&about, &about.scaled(-2.0)), "multiples");
        assert!(!commute(&about, &turn(DVec3::Z, DVec3::Y)), "parallel axes");
        assert!(!commute(&about, &turn(DVec3::X, DVec3::X)), "crossing axes");
    }
}
