//! Kinematic chains between instruments and targets.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::state::{InstrumentMount, KinematicTree, Sight};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Body, Mount, Robot};
use poecal_model::simulate::pairs;

/// Joints that move a target against an instrument: measurements of such a pair can determine only these.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct KinematicPath {
    /// Name of the instrument; `None` for a device beside the robot.
    pub instrument: Option<String>,
    /// Name of the target; `None` for the tip.
    pub target: Option<String>,
    /// Joints, from the instrument on.
    pub joints: Vec<String>,
    /// Number of rows; `None` without measurements.
    pub rows: Option<usize>,
}

/// Kinematic chains of some measurements; without measurements, of all instruments and targets that a model names.
#[must_use]
pub fn ways(robot: &Robot, data: Option<&Dataset>) -> Vec<KinematicPath> {
    match data {
        Some(data) => of_rows(robot, data),
        None => of_model(robot),
    }
}

fn joints(robot: &Robot, tree: &KinematicTree, sight: Sight) -> Vec<String> {
    let passed = tree.route(sight).iter().filter_map(|passed| robot.joints.get(passed.joint));
    passed.map(|joint| joint.name.clone()).collect()
}

fn of_rows(robot: &Robot, data: &Dataset) -> Vec<KinematicPath> {
    let tree = KinematicTree::from_robot(robot, data);
    let mut known: BTreeMap<_, (Sight, usize)> = BTreeMap::new();
    for row in &data.observations {
        let sight = Sight::from(row);
        known.entry((sight.station, sight.target, sight.from.is_some())).or_insert((sight, 0)).1 += 1;
    }
    let way = |(sight, rows): (Sight, usize)| KinematicPath {
        instrument: data.stations.get(sight.station).cloned().flatten(),
        target: data.targets.get(sight.target).cloned().flatten(),
        joints: joints(robot, &tree, sight),
        rows: Some(rows),
    };
    known.into_values().map(way).collect()
}

fn of_model(robot: &Robot) -> Vec<KinematicPath> {
    let way = |(instrument, target): (Option<&Mount>, Option<&Mount>)| {
        let stand = InstrumentMount::On(instrument.map_or(Body::Base, |mount| mount.body));
        let body = target.map_or_else(|| robot.tip_body(), |mount| mount.body);
        let tree = KinematicTree::new(robot, vec![stand], vec![body]);
        let name = |mount: Option<&Mount>| mount.map(|mount| mount.name.clone());
        let (instrument, target) = (name(instrument), name(target));
        KinematicPath { instrument, target, joints: joints(robot, &tree, Sight::from(0)), rows: None }
    };
    pairs(robot).into_iter().map(way).collect()
}
