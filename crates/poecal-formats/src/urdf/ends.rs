//! End links of a tree with the moving joints above them, found in one walk.

use std::collections::BTreeSet;

use super::tree::UrdfTree;

/// An end link below a moving joint.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct EndLink {
    pub(crate) link: usize,
    /// True if all moving joints above it lead mimic joints elsewhere, like the motor beside a telescopic column.
    pub(crate) only_leads: bool,
}

/// All end links below a base, or below every root, in the order of the file.
pub(crate) fn ends(tree: &UrdfTree, base: Option<usize>) -> Vec<EndLink> {
    let below = joints_below(tree);
    let leaders: Vec<BTreeSet<usize>> = tree.joints.iter().map(|joint| leaders_of(tree, joint)).collect();
    let mut way = JointPath::new(tree, &leaders);
    let mut ends = Vec::new();
    let starts = match base {
        Some(base) => vec![base],
        None => (0..tree.links.len()).filter(|&link| tree.parent_joint(link).is_none()).collect(),
    };
    for start in starts {
        // Links to visit, and joints to return by. Not recursive: a chain may be longer than the stack.
        let mut steps = vec![WalkStep::To(start, None)];
        while let Some(step) = steps.pop() {
            let (link, joint) = match step {
                WalkStep::Back(joint) => {
                    way.leave(joint);
                    continue;
                }
                WalkStep::To(link, joint) => (link, joint),
            };
            if let Some(joint) = joint {
                way.enter(joint);
                steps.push(WalkStep::Back(joint));
            }
            let children = below.get(link).map_or(&[][..], Vec::as_slice);
            if children.is_empty() && way.moving > 0 {
                ends.push(EndLink { link, only_leads: way.alone == 0 });
            }
            steps.extend(children.iter().map(|&joint| WalkStep::To(tree.joints[joint].child, Some(joint))));
        }
    }
    ends.sort_unstable_by_key(|end| end.link);
    ends
}

/// Joints that move below a link, each with the first end link that it moves, in the order of the file.
pub(crate) fn joints_beyond(tree: &UrdfTree, link: usize) -> Vec<(String, String)> {
    let below = joints_below(tree);
    let children = |link: usize| below.get(link).map_or(&[][..], Vec::as_slice);
    // Parents precede their children.
    let mut order = children(link).to_vec();
    let mut at = 0;
    while let Some(&joint) = order.get(at) {
        order.extend(children(tree.joints[joint].child));
        at += 1;
    }
    let mut ends: Vec<usize> = tree.joints.iter().map(|joint| joint.child).collect();
    for &joint in order.iter().rev() {
        if let Some(&next) = children(tree.joints[joint].child).first() {
            ends[joint] = ends[next];
        }
    }
    order.sort_unstable();
    let moving = order.into_iter().filter(|&joint| tree.joints[joint].kind.moves());
    moving.map(|joint| (tree.joints[joint].name.to_owned(), tree.link_name(ends[joint]).to_owned())).collect()
}

/// The links below a moving joint at which paths to several ends part, such as a flange with two tools, the nearest to the ends first. Each has the
/// number of moving joints above it.
pub(crate) fn forks(tree: &UrdfTree, base: Option<usize>, ends: &[EndLink]) -> Vec<(usize, usize)> {
    let mut ways = vec![0_usize; tree.links.len()];
    for end in ends {
        let mut at = end.link;
        while base != Some(at)
            && let Some((_, joint)) = tree.parent_joint(at)
        {
            at = joint.parent;
            ways[at] += 1;
            if ways[at] > 1 {
                // Its own path upwards is already counted.
                break;
            }
        }
    }
    // Numbers of joints above links, each of which is determined once.
    let mut above: Vec<Option<usize>> = vec![None; tree.links.len()];
    let mut forks: Vec<(usize, usize)> = Vec::new();
    for fork in (0..ways.len()).filter(|link| ways[*link] > 1) {
        let (mut way, mut at) = (Vec::new(), fork);
        let mut count = loop {
            match (above[at], tree.parent_joint(at).filter(|_| base != Some(at))) {
                (Some(known), _) => break known,
                (None, Some((_, joint))) => {
                    way.push((at, joint.kind.moves()));
                    at = joint.parent;
                }
                (None, None) => break 0,
            }
        };
        for (link, moves) in way.into_iter().rev() {
            count += usize::from(moves);
            above[link] = Some(count);
        }
        if count > 0 {
            forks.push((fork, count));
        }
    }
    forks.sort_by_key(|it| std::cmp::Reverse(it.1));
    forks
}

enum WalkStep {
    To(usize, Option<usize>),
    Back(usize),
}

/// Joints below each link.
fn joints_below(tree: &UrdfTree) -> Vec<Vec<usize>> {
    let mut below = vec![Vec::new(); tree.links.len()];
    for (index, joint) in tree.joints.iter().enumerate() {
        if let Some(joints) = below.get_mut(joint.parent) {
            joints.push(index);
        }
    }
    below
}

/// The joints that a joint mimics.
fn leaders_of(tree: &UrdfTree, joint: &super::tree::TreeJoint<'_>) -> BTreeSet<usize> {
    let mimics = tree.source.children(joint.node, "mimic");
    mimics.filter_map(|mimic| tree.joint_index(mimic.attribute("joint")?)).collect()
}

/// Joints from the start of a walk to its current link.
struct JointPath<'a> {
    tree: &'a UrdfTree<'a>,
    leaders: &'a [BTreeSet<usize>],
    /// True for each joint on the path; then, for each joint, the number of its followers elsewhere.
    is_on: Vec<bool>,
    elsewhere: Vec<usize>,
    /// Moving joints on the path, and those of them that lead no joint elsewhere.
    moving: usize,
    alone: usize,
}

impl<'a> JointPath<'a> {
    fn new(tree: &'a UrdfTree<'a>, leaders: &'a [BTreeSet<usize>]) -> Self {
        let count = tree.joints.len();
        let mut elsewhere = vec![0; count];
        leaders.iter().flatten().for_each(|&leader| elsewhere[leader] += 1);
        JointPath { tree, leaders, is_on: vec![false; count], elsewhere, moving: 0, alone: 0 }
    }

    fn counts(&self, joint: usize) -> bool {
        self.is_on[joint] && self.tree.joints[joint].kind.moves()
    }

    fn is_alone(&self, joint: usize) -> bool {
        self.counts(joint) && self.elsewhere[joint] == 0
    }

    fn enter(&mut self, joint: usize) {
        for &leader in &self.leaders[joint] {
            self.elsewhere[leader] -= 1;
            self.alone += usize::from(self.is_alone(leader));
        }
        self.is_on[joint] = true;
        self.moving += usize::from(self.counts(joint));
        self.alone += usize::from(self.is_alone(joint));
    }

    fn leave(&mut self, joint: usize) {
        self.moving -= usize::from(self.counts(joint));
        self.alone -= usize::from(self.is_alone(joint));
        self.is_on[joint] = false;
        for &leader in &self.leaders[joint] {
            self.alone -= usize::from(self.is_alone(leader));
            self.elsewhere[leader] += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::urdf::{ChainSelection, UrdfDocument};
    use std::fmt::Write;

    fn message(urdf: &str) -> String {
        UrdfDocument::parse(urdf, "r.urdf", &ChainSelection::default()).unwrap_err().to_string()
    }

    fn joint(name: &str, parent: &str, child: &str) -> String {
        format!(
            "<link name=\"{child}\"/><joint name=\"{name}\" type=\"continuous\"><parent link=\"{parent}\"/>\
             <child link=\"{child}\"/></joint>\n"
        )
    }

    /// A flange with a tool and a camera, beside a second arm: the links below moving joints at which the paths part.
    #[test]
    fn links_before_a_fork_can_be_chosen() {
        let fixed = |name: &str, parent: &str, child: &str| joint(name, parent, child).replace("continuous", "fixed");
        let arm = joint("j1", "base", "torso") + &joint("j2", "torso", "wrist") + &fixed("f", "wrist", "flange");
        let ends = fixed("t", "flange", "tool0") + &fixed("c", "flange", "camera") + &joint("j3", "torso", "left");
        let urdf = format!("<robot name=\"r\"><link name=\"base\"/>{arm}{ends}</robot>");
        let error = UrdfDocument::parse(&urdf, "r.urdf", &ChainSelection::default()).unwrap_err();
        assert!(
            error.message().starts_with(
                "found 3 end links with a moving joint above them (`tool0`, `camera`, `left`), expected one: choose it, or a link before they part \
                 (`flange`, `torso`), with --tip-link"
            ),
            "{error}"
        );
        let choices = error.choices().unwrap();
        assert_eq!((choices.option, choices.of.join(" ")), ("--tip-link", "flange torso tool0 camera left".to_owned()));
        for (link, joints) in [("flange", 2), ("torso", 1), ("left", 2)] {
            let selection = ChainSelection { tip_link: Some(link.to_owned()), ..ChainSelection::default() };
            assert_eq!(
                UrdfDocument::parse(&urdf, "r.urdf", &selection).unwrap().robot().joints.len(),
                joints,
                "{link}"
            );
        }
    }

    /// A star, and a comb: the path from each tooth to the root is long.
    #[test]
    fn the_ends_of_a_tree_of_very_many_branches_are_found_by_one_walk() {
        const COUNT: usize = 20_000;
        let (mut star, mut comb) =
            ("<robot name=\"r\"><link name=\"l0\"/>".to_owned(), "<robot name=\"r\"><link name=\"l0\"/>".to_owned());
        for k in 1..=COUNT {
            star += &joint(&format!("j{k}"), "l0", &format!("l{k}"));
            comb += &joint(&format!("j{k}"), &format!("l{}", k - 1), &format!("l{k}"));
            comb += &joint(&format!("t{k}"), &format!("l{}", k - 1), &format!("tooth{k}"));
        }
        for (mut urdf, ends, first) in [(star, COUNT, "`l1`, `l2`"), (comb, COUNT + 1, "`tooth1`, `tooth2`")] {
            write!(urdf, "</robot>").unwrap();
            let message = message(&urdf);
            let expected = format!("r.urdf: found {ends} end links with a moving joint above them ({first}, ");
            assert!(message.starts_with(&expected), "{message}");
            assert!(message.len() < 400, "{message}");
        }
    }
}
