//! Names of links for forms in which each name must be unique.

use std::collections::BTreeSet;

use poecal_model::robot::Robot;

/// Names that no other part of the text has, and that no reader reserves.
pub(crate) struct ExportNames {
    pub(crate) base: String,
    pub(crate) tip: String,
    pub(crate) joints: Vec<String>,
    /// The link that each joint moves.
    pub(crate) links: Vec<String>,
    /// The joint that holds the tip.
    pub(crate) mount: String,
}

impl ExportNames {
    /// Names of a robot, changed as little as possible: joints keep theirs if they can.
    pub(crate) fn from_robot(robot: &Robot) -> Self {
        let mut taken = BTreeSet::from(["world".to_owned()]);
        let mut free = |name: &str| {
            let mut name = name.replace("::", "_");
            if name.starts_with("__") && name.ends_with("__") {
                name.push_str("link");
            }
            while !taken.insert(name.clone()) {
                name.push('_');
            }
            name
        };
        let joints = robot.joints.iter().map(|joint| free(&joint.name)).collect();
        let (base, tip) = (free(&robot.base_name), free(&robot.tip_name));
        let links = robot.joints.iter().map(|joint| free(&format!("{}_link", joint.name))).collect();
        let mount = free(&format!("{}_fixed", robot.tip_name));
        ExportNames { base, tip, joints, links, mount }
    }

    /// A note on names that were changed.
    pub(crate) fn note(&self, robot: &Robot) -> Option<String> {
        let own = robot.joints.iter().map(|joint| &joint.name).chain([&robot.base_name, &robot.tip_name]);
        let changed = own.zip(self.joints.iter().chain([&self.base, &self.tip])).filter(|(a, b)| a != b);
        let words: Vec<String> = changed.map(|(from, to)| format!("`{from}` is `{to}` there")).collect();
        (!words.is_empty())
            .then(|| format!("names that this form reserves or has twice are others: {}", words.join(", ")))
    }
}
