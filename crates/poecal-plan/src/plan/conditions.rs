//! Conditions of measurement: limits with a margin, keep-out boxes, the floor, self-collision, and the view of the device.

use std::fmt::Write as _;

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::capsule::{Capsule, segment_distance};
use super::order::TravelDistance;
use super::skeleton::{links, targets, to_targets};
use poecal_arm::lie::Pose;
use poecal_model::robot::{Body, ReadingKind, Robot};
use poecal_model::simulate::Configurations;

/// Number of random configurations in all of which capsules of one part overlap, and their seed.
const TOGETHER: usize = 1000;
const SEED: u64 = 7;
/// Distance of new configurations from those that they replace, in some joint, radians.
const AWAY_RAD: f64 = 0.175;
/// Distance before its target at which a line of sight ends, metres: the target would hide itself.
const AT_TARGET_M: f64 = 1e-3;

/// Conditions under which a configuration can be measured. All positions are in the robot's base frame.
///
/// ```
/// use poecal_plan::plan::Conditions;
/// assert!(Conditions::default().capsules.is_empty());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conditions {
    /// Distance of every joint from its limits: turning, radians, and sliding, metres. By default [`Configurations::MARGIN`] if configurations are
    /// chosen freely, and zero for a list.
    pub margin: Option<[f64; 2]>,
    /// Boxes into which no part of the robot may reach, by two corners, metres.
    pub keep_out: Vec<[[f64; 3]; 2]>,
    /// Height above which all moving links stay, metres.
    pub floor_m: Option<f64>,
    /// Least change of a joint between any two configurations, radians; for a sliding joint over the length that a radian counts.
    pub separation_rad: f64,
    /// View of the device.
    pub sight: Option<DeviceView>,
    /// Shapes of the links. Without any, neither self-collision nor hidden targets are found, and keep-out boxes and floor hold for the axes alone.
    pub capsules: Vec<Capsule>,
}

/// Position of a device, and its field of view.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceView {
    /// Position, metres.
    pub place: Vector3<f64>,
    /// A point at which it aims, and half the angle of its cone, radians.
    pub cone: Option<(Vector3<f64>, f64)>,
    /// Least and largest distance of the target, metres.
    pub distance_m: [f64; 2],
    /// Largest angle at the target between the line to the device and the target's normal, radians.
    pub acceptance_rad: Option<f64>,
    /// Normal of the target, in its own frame.
    pub facing: Vector3<f64>,
}

/// A condition that a configuration does not fulfil.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Obstacle {
    /// A joint is at its limit, or beyond.
    Limits,
    /// A link is in a keep-out box.
    KeepOut,
    /// A link is below the floor.
    Floor,
    /// Two links overlap.
    Collision,
    /// The target is outside the device's cone.
    Cone,
    /// The target is too near or too far from the device.
    Distance,
    /// The target is turned away.
    Incidence,
    /// A link is between device and target.
    Hidden,
    /// The configuration is near one that could not be measured.
    Avoided,
}

impl Obstacle {
    const ALL: [Obstacle; 9] = [
        Obstacle::Limits,
        Obstacle::KeepOut,
        Obstacle::Floor,
        Obstacle::Collision,
        Obstacle::Cone,
        Obstacle::Distance,
        Obstacle::Incidence,
        Obstacle::Hidden,
        Obstacle::Avoided,
    ];

    /// Description of the obstacle.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Obstacle::Limits => "limits of the joints with their margin",
            Obstacle::KeepOut => "keep-out boxes",
            Obstacle::Floor => "the floor",
            Obstacle::Collision => "links that overlap",
            Obstacle::Cone => "the device's cone",
            Obstacle::Distance => "the device's distances",
            Obstacle::Incidence => "the direction in which the target looks",
            Obstacle::Hidden => "links before the target",
            Obstacle::Avoided => "rows that are replaced",
        }
    }
}

/// Number of configurations that each condition rejected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefusalCounts {
    counts: [usize; Obstacle::ALL.len()],
    /// Number of examined configurations.
    pub tried: usize,
}

impl RefusalCounts {
    pub(crate) fn add(&mut self, obstacle: Option<Obstacle>) {
        self.tried += 1;
        if let Some(obstacle) = obstacle {
            self.counts[obstacle as usize] += 1;
        }
    }

    /// Conditions that rejected some, with their numbers.
    pub fn iter_counts(&self) -> impl Iterator<Item = (Obstacle, usize)> {
        Obstacle::ALL.into_iter().zip(self.counts).filter(|it| it.1 > 0)
    }

    /// The numbers in words.
    #[must_use]
    pub fn words(&self) -> String {
        let mut out = String::new();
        for (obstacle, count) in self.iter_counts() {
            // Writing to a String cannot fail.
            let _ = write!(out, "{}{count} by {}", if out.is_empty() { "" } else { ", " }, obstacle.words());
        }
        out
    }
}

/// Conditions of a robot, ready to judge configurations.
pub(crate) struct Checker<'a> {
    robot: &'a Robot,
    /// Ranges of chosen configurations: with their margin, within a turn.
    configurations: Configurations,
    /// Ranges of listed ones.
    allowed: Configurations,
    conditions: &'a Conditions,
    avoided: &'a [f64],
    travel: TravelDistance,
    /// Pairs of capsules that must not overlap.
    pairs: Vec<(usize, usize)>,
    /// Pairs that overlap in every configuration and are left out.
    pub(crate) left_out: Vec<(String, String)>,
}

impl<'a> Checker<'a> {
    pub(crate) fn new(robot: &'a Robot, conditions: &'a Conditions) -> Self {
        let within = |usual| Configurations::new(robot).shrink_ranges(conditions.margin.unwrap_or(usual));
        let (configurations, allowed) = (within(Configurations::MARGIN).within_a_turn(), within([0.0; 2]));
        let capsules = &conditions.capsules;
        let before = |body: Body| body.joint().map(|joint| robot.body_before(joint));
        let are_neighbours = |a: Body, b: Body| a == b || before(a) == Some(b) || before(b) == Some(a);
        let all = (0..capsules.len()).flat_map(|a| (a + 1..capsules.len()).map(move |b| (a, b)));
        let mut pairs: Vec<(usize, usize)> =
            all.filter(|&(a, b)| !are_neighbours(capsules[a].body, capsules[b].body)).collect();
        let mut always = vec![!pairs.is_empty(); pairs.len()];
        let mut generator = ChaCha8Rng::seed_from_u64(SEED);
        for _ in 0..TOGETHER {
            if !always.contains(&true) {
                break;
            }
            let frames = robot.joint_poses(&configurations.random(&mut generator));
            let segments: Vec<_> = capsules.iter().map(|it| it.segment(&frames)).collect();
            for (is_always, &(a, b)) in always.iter_mut().zip(&pairs) {
                *is_always = *is_always
                    && segment_distance(&segments[a], &segments[b]) < capsules[a].radius_m + capsules[b].radius_m;
            }
        }
        let mut left_out: Vec<(String, String)> = Vec::new();
        let mut always = always.into_iter();
        pairs.retain(|&(a, b)| {
            let is_always = always.next() == Some(true);
            let names = (capsules[a].link.clone(), capsules[b].link.clone());
            if is_always && !left_out.contains(&names) {
                left_out.push(names);
            }
            !is_always
        });
        Checker {
            robot,
            configurations,
            allowed,
            conditions,
            avoided: &[],
            travel: TravelDistance::new(robot, 1.0),
            pairs,
            left_out,
        }
    }

    /// The checker with configurations that others must avoid.
    pub(crate) fn with_avoided(self, avoided: &'a [f64], length_m: f64) -> Self {
        Checker { avoided, travel: TravelDistance::new(self.robot, length_m), ..self }
    }

    /// Ranges of chosen readings.
    pub(crate) fn configurations(&self) -> &Configurations {
        &self.configurations
    }

    /// Obstacle to the robot's presence there, apart from the device.
    pub(crate) fn robot(&self, readings: &[f64]) -> Option<Obstacle> {
        if !self.allowed.contain(readings) {
            return Some(Obstacle::Limits);
        }
        let Conditions { keep_out, floor_m, capsules, .. } = self.conditions;
        if keep_out.is_empty() && floor_m.is_none() && self.pairs.is_empty() {
            return None;
        }
        let frames = self.robot.joint_poses(readings);
        let segments: Vec<[Vector3<f64>; 2]> = capsules.iter().map(|it| it.segment(&frames)).collect();
        let parts = self.parts(readings, &frames, &segments);
        if keep_out.iter().any(|corners| parts.iter().any(|(segment, radius)| is_in(segment, *radius, corners))) {
            return Some(Obstacle::KeepOut);
        }
        // The frame of a joint on the base does not move, at any position.
        let is_fixed = |place: &Vector3<f64>| {
            let mut own = (0..frames.len()).filter(|&joint| self.robot.body_before(joint) == Body::Base);
            capsules.is_empty() && own.any(|joint| frames[joint].translation == *place)
        };
        let is_low = |place: &Vector3<f64>, low: f64| place.z < low && !is_fixed(place);
        if let Some(floor) = floor_m
            && parts.iter().any(|(ends, radius)| ends.iter().any(|end| is_low(end, floor + radius)))
        {
            return Some(Obstacle::Floor);
        }
        let overlaps = |&(a, b): &(usize, usize)| {
            segment_distance(&segments[a], &segments[b]) < capsules[a].radius_m + capsules[b].radius_m
        };
        self.pairs.iter().any(overlaps).then_some(Obstacle::Collision)
    }

    /// Moving parts: the capsules, else the lines between axes, with the targets.
    fn parts(
        &self,
        readings: &[f64],
        frames: &[Pose],
        segments: &[[Vector3<f64>; 2]],
    ) -> Vec<([Vector3<f64>; 2], f64)> {
        let moving = self.conditions.capsules.iter().zip(segments).filter(|(it, _)| it.body != Body::Base);
        let mut parts: Vec<_> = moving.map(|(it, segment)| (*segment, it.radius_m)).collect();
        if parts.is_empty() {
            parts.extend(links(self.robot, frames).into_iter().map(|line| (line, 0.0)));
        }
        parts.extend(to_targets(self.robot, readings, frames).into_iter().map(|line| (line, 0.0)));
        parts
    }

    /// Obstacle to measuring there.
    pub(crate) fn obstacle_to_measuring(&self, readings: &[f64]) -> Option<Obstacle> {
        let mut avoided = self.avoided.chunks_exact(readings.len().max(1));
        if avoided.any(|it| self.travel.distance(it, readings) < AWAY_RAD) {
            return Some(Obstacle::Avoided);
        }
        self.robot(readings).or_else(|| self.sight(readings))
    }

    fn sight(&self, readings: &[f64]) -> Option<Obstacle> {
        let sight = self.conditions.sight.as_ref()?;
        let frames = self.robot.joint_poses(readings);
        for (place, pose, body) in targets(self.robot, readings, &frames) {
            let line = place - sight.place;
            let distance = line.norm();
            if !(sight.distance_m[0]..=sight.distance_m[1]).contains(&distance) {
                return Some(Obstacle::Distance);
            }
            if let Some((at, half)) = sight.cone
                && (at - sight.place).angle(&line) > half
            {
                return Some(Obstacle::Cone);
            }
            if let Some(acceptance) = sight.acceptance_rad
                && (pose.rotation * sight.facing).angle(&-line) > acceptance
            {
                return Some(Obstacle::Incidence);
            }
            let end = place - line * (AT_TARGET_M / distance.max(AT_TARGET_M));
            let hides = |capsule: &Capsule| {
                let segment = capsule.segment(&frames);
                // The link before may be slimmer beside the target than its capsule: then it hides only lines of sight past its middle.
                let is_before = body.joint().map(|joint| self.robot.body_before(joint)) == Some(capsule.body);
                let slim =
                    if is_before { segment_distance(&segment, &[place, place]) - AT_TARGET_M } else { f64::INFINITY };
                let around = capsule.radius_m.min(slim);
                capsule.body != body && segment_distance(&segment, &[sight.place, end]) < around
            };
            if self.conditions.capsules.iter().any(hides) {
                return Some(Obstacle::Hidden);
            }
        }
        None
    }

    /// Readings without limits.
    pub(crate) fn without_limits(&self) -> Vec<String> {
        let robot = self.robot;
        let open = |name: &&String| {
            robot.reading_kind(name) != ReadingKind::Factor
                && robot.joints.iter().filter(|joint| joint.reading.name == **name).all(|it| it.limits.is_none())
        };
        robot.reading_names().iter().filter(open).cloned().collect()
    }
}

/// True if a capsule extends into a box: steps along it of half its radius, at most a centimetre, each with the surrounding ball.
fn is_in([a, b]: &[Vector3<f64>; 2], radius: f64, corners: &[[f64; 3]; 2]) -> bool {
    let length = (b - a).norm();
    let steps = (length / (0.5 * radius).clamp(2e-3, 1e-2)).ceil().max(1.0) as usize;
    let reach = radius + 0.5 * length / steps as f64;
    (0..=steps).any(|step| {
        let at = a + (b - a) * (step as f64 / steps as f64);
        let off = |k: usize| (corners[0][k] - at[k]).max(at[k] - corners[1][k]).max(0.0);
        (0..3).map(|k| off(k).powi(2)).sum::<f64>() < reach * reach
    })
}
