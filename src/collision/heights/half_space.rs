//! Half-spaces as obstacles: the first contact with one, and all times of contact.
//!
//! A clearance to keep raises the plane, and a depth that is allowed lowers it: in each case what
//! counts is the first vertex behind a plane.

use super::Side;
use super::lowest::{Lowest, lowest};
use super::timeline::{Sided, Timeline};
use crate::collision::plane::Plane;
use crate::collision::scene::Scene;
use crate::collision::{ContactRule, Feature, FirstContact, Limited, Touch, Verdict};
use crate::numeric::index;
use crate::watch::Interrupted;

/// The earliest of a verdict and of the times at which half-spaces are met.
pub(in crate::collision) fn or_met(
    scene: &Scene,
    verdict: Verdict,
) -> Result<Verdict, Interrupted> {
    let mut first = verdict;
    for number in 0..scene.obstacles.len() {
        let Some(plane) = scene.plane(number) else {
            continue;
        };
        let met = Met {
            scene,
            number,
            plane,
        };
        let found = match scene.rule(number) {
            ContactRule::Allowed => None,
            ContactRule::Touch => met.touched()?,
            ContactRule::Enter { .. } => met.entered()?,
        };
        if let Some(found) = found
            && is_before(&found, &first)
        {
            first = found;
        }
    }
    Ok(first)
}

/// Whether a verdict is about an earlier event; contact counts before a distance.
fn is_before(a: &Verdict, b: &Verdict) -> bool {
    let key = |verdict: &Verdict| match verdict {
        Verdict::Contact(first) => (first.time, 0),
        Verdict::Closer(first) => (first.time, 1),
        Verdict::Undecided { window, .. } => (window[0], 2),
        Verdict::Clear => (f64::INFINITY, 3),
    };
    key(a) < key(b)
}

/// The meeting of the body with one half-space.
struct Met<'a> {
    scene: &'a Scene<'a>,
    number: usize,
    plane: &'a Plane,
}

impl<'a> Met<'a> {
    /// The heights over a level; `None` where the motion is too long.
    fn timeline(&self, level: f64) -> Option<Timeline<'a>> {
        let scene = self.scene;
        let movers = |stage| scene.movers(self.number, stage);
        Timeline::new(scene.body, &scene.stages, movers, self.plane, level)
    }

    /// The plane, and the lowest vertex of the body, at a time on the clock.
    fn lowest_at(&self, time: f64) -> (Plane, Lowest) {
        let scene = self.scene;
        let before = scene.stages.partition_point(|stage| stage.times[1] < time);
        let stage = before.min(scene.stages.len() - 1);
        let local = scene.stages[stage].local(time);
        let movers = scene.movers(self.number, stage);
        let plane = self.plane.placed(&movers[1].pose(local));
        (plane, lowest(scene.body, &movers[0].pose(local), &plane))
    }

    /// What is not known where the motion is too long.
    fn too_long(&self) -> Verdict {
        let stages = &self.scene.stages;
        Verdict::Undecided {
            window: [stages[0].times[0], stages[stages.len() - 1].times[1]],
            span: stages[0].span,
            obstacle: self.number,
            limited: Limited::Work,
        }
    }

    /// When the body touches it, or comes nearer than the clearance.
    fn touched(&self) -> Result<Option<Verdict>, Interrupted> {
        let clearance = self.scene.settings.clearance;
        let Some(timeline) = self.timeline(clearance) else {
            return Ok(Some(self.too_long()));
        };
        let slack = timeline.windows[0].slack;
        let start = self.scene.stages[0].times[0];
        let (_, low) = self.lowest_at(start);
        if low.height <= slack {
            return Ok(Some(Verdict::Contact(self.at_start(low.height, slack))));
        }
        if low.height <= clearance + slack {
            let found = self.at_start(low.height - clearance, slack);
            return Ok(Some(Verdict::Closer(found)));
        }
        let meets = |sided: &Sided| Some(sided.stay.times[0]);
        let found = timeline.first(meets, self.scene.work.uncounted())?;
        Ok(found.map(|(sided, bracket)| {
            let touch = self.what_follows(&sided, &timeline);
            let found = self.contact(&sided, bracket, touch);
            if clearance > 0.0 {
                Verdict::Closer(found)
            } else {
                Verdict::Contact(found)
            }
        }))
    }

    /// When it is entered deeper than its depth.
    fn entered(&self) -> Result<Option<Verdict>, Interrupted> {
        let Some(depth) = self.scene.depth(self.number) else {
            return Ok(None);
        };
        let Some(timeline) = self.timeline(-depth) else {
            return Ok(Some(self.too_long()));
        };
        let slack = timeline.windows[0].slack;
        let start = self.scene.stages[0].times[0];
        let (_, low) = self.lowest_at(start);
        if low.height < -depth - slack {
            let found = self.at_start(low.height + depth, slack);
            return Ok(Some(Verdict::Contact(found)));
        }
        let passes =
            |sided: &Sided| (sided.sides[1] == Some(Side::Behind)).then_some(sided.stay.bracket[1]);
        let found = timeline.first(passes, self.scene.work.uncounted())?;
        Ok(found
            .map(|(sided, bracket)| Verdict::Contact(self.contact(&sided, bracket, Touch::Enter))))
    }

    /// The contact of the lowest vertex at the start.
    ///
    /// - `height`: over the level that counts.
    fn at_start(&self, height: f64, slack: f64) -> FirstContact {
        let stage = &self.scene.stages[0];
        let time = stage.times[0];
        let (plane, low) = self.lowest_at(time);
        let touch = if height < -PROBE_MARGIN * slack {
            Touch::Inside
        } else {
            self.soon_after(time, low.height - height, slack)
        };
        FirstContact {
            time,
            bracket: [time; 2],
            span: stage.span,
            obstacle: self.number,
            features: [Feature::Vertex(low.vertex), PLANE],
            touch,
            point: low.place - low.height * plane.normal(),
            normal: plane.normal(),
        }
    }

    fn contact(&self, sided: &Sided, bracket: [f64; 2], touch: Touch) -> FirstContact {
        let stage = &self.scene.stages[sided.stay.stage];
        let time = bracket[1];
        let local = stage.local(time);
        let movers = self.scene.movers(self.number, sided.stay.stage);
        let [body, carried] = [0, 1].map(|i: usize| movers[i].pose(local));
        let plane = self.plane.placed(&carried);
        let place = body.transform_point3(sided.stay.position);
        FirstContact {
            time,
            bracket,
            span: stage.span,
            obstacle: self.number,
            features: [Feature::Vertex(sided.stay.vertex), PLANE],
            touch,
            point: place - plane.height(place) * plane.normal(),
            normal: plane.normal(),
        }
    }

    /// How a contact goes on.
    fn what_follows(&self, sided: &Sided, timeline: &Timeline) -> Touch {
        let level = self.scene.settings.clearance;
        let slacks = timeline.windows.iter().map(|window| window.slack);
        let slack = slacks.fold(0.0, f64::max);
        self.soon_after(sided.stay.times[0], level, slack)
    }

    /// How a contact at a height goes on slightly later.
    fn soon_after(&self, time: f64, level: f64, slack: f64) -> Touch {
        let scene = self.scene;
        let after = scene.stages.partition_point(|stage| stage.times[1] <= time);
        let Some(stage) = scene.stages.get(after) else {
            return Touch::Touch;
        };
        let movers = scene.movers(self.number, after);
        let local = stage.local(time);
        let speed = movers[0].speed(local) + movers[1].speed(local);
        let [low, high] = scene.body.bounds();
        let step = PROBE_DISTANCE * low.distance(high) / speed;
        if !step.is_finite() || local + step > 1.0 {
            // Nothing moves, or nothing follows.
            return Touch::Touch;
        }
        let (_, low) = self.lowest_at(stage.clock(local + step));
        let height = low.height - level;
        if height < -PROBE_MARGIN * slack {
            Touch::Enter
        } else if height <= PROBE_MARGIN * slack {
            Touch::Slide
        } else {
            Touch::Touch
        }
    }
}

/// All times of contact with a half-space (below the clearance, or entered), in order; `None` where
/// the motion is too long.
pub(in crate::collision) fn intervals(
    scene: &Scene,
    number: usize,
    plane: &Plane,
) -> Result<Option<Vec<[f64; 2]>>, Interrupted> {
    let met = Met {
        scene,
        number,
        plane,
    };
    let depth = scene.depth(number);
    let level = depth.map_or(scene.settings.clearance, |depth| -depth);
    let Some(timeline) = met.timeline(level) else {
        return Ok(None);
    };
    let stages = &scene.stages;
    let whole = [stages[0].times[0], stages[stages.len() - 1].times[1]];
    let all = timeline.sided(timeline.windows.len(), scene.work.uncounted())?;
    let mut times: Vec<[f64; 2]> = Vec::new();
    let mut meets = vec![false; scene.body.vertices()];
    for own in all.chunk_by(|a, b| a.stay.vertex == b.stay.vertex) {
        meets[own[0].stay.vertex as usize] = true;
        let mut from = whole[0];
        for Sided { stay, sides } in own {
            // Behind up to here, in the plane, and behind again.
            if sides[0] == Some(Side::Behind) {
                times.push([from, stay.times[0]]);
            }
            if depth.is_none() {
                times.push(stay.times);
            }
            from = stay.times[1];
        }
        if own
            .last()
            .is_some_and(|last| last.sides[1] == Some(Side::Behind))
        {
            times.push([from, whole[1]]);
        }
    }
    let is_behind = |vertex: u32| {
        let [body, carried] = [0, 1].map(|i: usize| scene.movers(number, 0)[i].pose(0.0));
        let place = body.transform_point3(scene.body.vertex(vertex));
        plane.placed(&carried).height(place) < level
    };
    let triangles = 0..index(scene.body.len());
    let mut vertices = triangles.flat_map(|triangle| scene.body.indices(triangle));
    if vertices.any(|vertex| !meets[vertex as usize] && is_behind(vertex)) {
        times.push(whole);
    }
    times.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut united: Vec<[f64; 2]> = Vec::new();
    for [start, end] in times {
        match united.last_mut() {
            Some(last) if start <= last[1] => last[1] = last[1].max(end),
            _ => united.push([start, end]),
        }
    }
    Ok(Some(united))
}

/// The plane as a feature of the half-space.
const PLANE: Feature = Feature::Face(0);

/// Distance that the fastest point covers before a contact is examined again, as a fraction of the
/// size of the body: as for other obstacles (`witness`).
const PROBE_DISTANCE: f64 = 1e-5;

/// Number of errors of position by which the body must be apart, or behind the plane, to count as
/// such when a contact is examined again.
const PROBE_MARGIN: f64 = 8.0;
