//! Links and joints of the robot: the chain from base to tip, the selected one or the only one, and the paths to named links.

use std::collections::BTreeSet;

use super::tree::UrdfTree;
use super::{ChainSelection, ends};
use poecal_numerics::error::{Error, ErrorKind, Result, nearest_or_all};
use poecal_storage::xml::XmlSource;

/// Links and joints of the robot, as indices into the tree. Each joint comes after the joint of its parent link: those from base to tip first.
pub(crate) struct UrdfChain {
    pub(crate) base: usize,
    /// Fixed joints from the base up to the link from which the others lead down, if the base is beside the chain.
    pub(crate) up: Vec<usize>,
    pub(crate) tip: usize,
    pub(crate) joints: Vec<usize>,
    /// Links of named instruments and targets.
    pub(crate) instruments: Vec<(String, usize)>,
    pub(crate) targets: Vec<(String, usize)>,
}

pub(crate) fn select(tree: &UrdfTree, selection: &ChainSelection) -> Result<UrdfChain> {
    let find = |name: &Option<String>, option| name.as_deref().map(|name| find_link(tree, name, option)).transpose();
    let named = |mounts: &[(String, String)], what: &str| -> Result<Vec<(String, usize)>> {
        let found =
            |(name, link): &(String, String)| Ok((name.clone(), find_link(tree, link, &format!("{what} `{name}`"))?));
        mounts.iter().map(found).collect()
    };
    let stated = find(&selection.base_link, "--base-link")?;
    let tip = find(&selection.tip_link, "--tip-link")?;
    let (mut base, up) = match stated {
        Some(base) => {
            let (top, up) = find_branch_link(tree, base, tip);
            (Some(top), up)
        }
        None => (None, Vec::new()),
    };
    let instruments = named(&selection.instruments, "instrument")?;
    let targets = named(&selection.targets, "target")?;
    let tip = match tip {
        Some(tip) => tip,
        None if targets.is_empty() => only_tip(tree, base)?,
        None => first_moved(tree, base, targets.iter().chain(&instruments)),
    };
    let mut chain = way_up(tree, base, tip, "tip")?;
    base.get_or_insert(chain.base);
    let mut known: BTreeSet<usize> = chain.joints.iter().copied().collect();
    for (what, mounts) in [("instrument", &instruments), ("target", &targets)] {
        for (name, link) in mounts {
            let further = way_up(tree, base, *link, &format!("{what} `{name}`: its"))?;
            chain.joints.extend(further.joints.into_iter().filter(|&joint| known.insert(joint)));
        }
    }
    (chain.instruments, chain.targets) = (instruments, targets);
    (chain.base, chain.up) = (stated.unwrap_or(chain.base), up);
    check_joints(tree, &chain)?;
    Ok(chain)
}

/// The link from which the chain leads down, and the fixed joints from the base up to it. It is the base itself if the tip, or a moving link, is
/// below it. Otherwise it is the nearest link above with this property, over fixed joints only.
fn find_branch_link(tree: &UrdfTree, base: usize, tip: Option<usize>) -> (usize, Vec<usize>) {
    let leads = |link: usize| match tip {
        Some(tip) => tip == link || tree.ancestors(tip).any(|(_, joint)| joint.parent == link),
        None => !ends::ends(tree, Some(link)).is_empty(),
    };
    let (mut at, mut up) = (base, Vec::new());
    while !leads(at) {
        match tree.parent_joint(at) {
            Some((index, joint)) if joint.kind == super::tree::JointType::Fixed => {
                up.push(index);
                at = joint.parent;
            }
            // A moving joint is in between: the error will concern the stated base.
            Some(_) | None => return (base, Vec::new()),
        }
    }
    (at, up)
}

/// The first of some links that a joint moves, else the first of all.
fn first_moved<'a>(
    tree: &UrdfTree,
    base: Option<usize>,
    mut links: impl Iterator<Item = &'a (String, usize)> + Clone,
) -> usize {
    let is_moved = |link: usize| {
        let below_base = tree.ancestors(link).scan(link, |at, (_, joint)| {
            let above = std::mem::replace(at, joint.parent);
            (base != Some(above)).then_some(joint.kind.moves())
        });
        below_base.into_iter().any(|moves| moves)
    };
    let first = links.clone().next();
    links.find(|(_, link)| is_moved(*link)).or(first).map_or(0, |(_, link)| *link)
}

fn error(source: &XmlSource, message: String) -> Error {
    ErrorKind::Model.error(message).in_file(source.path)
}

fn find_link(tree: &UrdfTree, name: &str, option: &str) -> Result<usize> {
    tree.link(name).ok_or_else(|| {
        let known = nearest_or_all(name, &tree.links);
        error(&tree.source, format!("{option} names link `{name}`, expected a link of this file, {known}"))
    })
}

/// The only end link below a moving joint (below `base`, if stated).
fn only_tip(tree: &UrdfTree, base: Option<usize>) -> Result<usize> {
    let error = |message: String| Err(error(&tree.source, message));
    let mut tips = ends::ends(tree, base);
    if tips.len() > 1 {
        tips.retain(|end| !end.only_leads);
    }
    match tips.as_slice() {
        [end] => Ok(end.link),
        [] => error(format!(
            "found no end link with a moving joint above it{}, expected a serial chain: choose one with --base-link and --tip-link",
            base.map_or(String::new(), |base| format!(" below base link `{}`", tree.link_name(base)))
        )),
        several => {
            let forks = ends::forks(tree, base, several);
            let named: Vec<&str> = forks.iter().map(|it| tree.link_name(it.0)).collect();
            let before = match named.get(..named.len().min(FORKS)) {
                Some(some @ [_, ..]) => {
                    format!(", or a link before they part ({}),", list(some.iter().copied()))
                }
                _ => String::new(),
            };
            let refused = error(format!(
                "found {} end links with a moving joint above them ({}), expected one: choose it{before} with --tip-link, and the base, if it is not the root, with --base-link",
                several.len(),
                list(several.iter().map(|end| tree.link_name(end.link)))
            ));
            let last = several.iter().map(|end| tree.link_name(end.link));
            let choices = named.iter().copied().chain(last).map(str::to_owned).collect();
            refused.map_err(|error| error.with_choices("--tip-link", choices))
        }
    }
}

/// Number of links before a fork that a message lists.
const FORKS: usize = 3;

/// Path from `tip` up to `base`, or to the root. `what` is the link at its end, for messages.
fn way_up(tree: &UrdfTree, base: Option<usize>, tip: usize, what: &str) -> Result<UrdfChain> {
    let mut at = tip;
    let mut joints = Vec::new();
    for (index, joint) in tree.ancestors(tip) {
        if base == Some(at) {
            break;
        }
        joints.push(index);
        at = joint.parent;
    }
    joints.reverse();
    match base {
        Some(base) if base != at => {
            let above: Vec<_> = tree.ancestors(tip).map(|(_, joint)| tree.link_name(joint.parent)).collect();
            let (known, or) = match above.is_empty() {
                true => ("there is none".to_owned(), ""),
                false => (list(above), ", or one that fixed joints join to these"),
            };
            let message = format!(
                "{what} link `{}` is not below base link `{}`, expected a base link above {} ({known}){or}",
                tree.link_name(tip),
                tree.link_name(base),
                if what == "tip" { "the tip" } else { "it" },
            );
            Err(error(&tree.source, message))
        }
        _ => Ok(UrdfChain { base: at, up: Vec::new(), tip, joints, instruments: Vec::new(), targets: Vec::new() }),
    }
}

fn check_joints(tree: &UrdfTree, chain: &UrdfChain) -> Result<()> {
    let (base, tip) = (tree.link_name(chain.base), tree.link_name(chain.tip));
    let named = !chain.instruments.is_empty() || !chain.targets.is_empty();
    let joints = || chain.joints.iter().filter_map(|&joint| tree.joints.get(joint));
    for joint in joints() {
        if !joint.kind.moves() && joint.kind != super::tree::JointType::Fixed {
            let place = if named {
                format!("on the way from `{base}` to the named links")
            } else {
                format!("between `{base}` and `{tip}`")
            };
            let message = format!(
                "joint `{}` {place} is {}, expected revolute, continuous, prismatic or fixed: choose a chain without it with --base-link and --tip-link",
                joint.name,
                joint.kind.word()
            );
            return Err(tree.source.error(joint.node, message));
        }
    }
    if !joints().any(|joint| joint.kind.moves()) {
        if named {
            let message = format!(
                "found no moving joint between base link `{base}` and the links of the named instruments and targets, expected at least \
                 one: name a link that a joint moves"
            );
            return Err(error(&tree.source, message));
        }
        let message = format!(
            "found no moving joint between base link `{base}` and tip link `{tip}`, expected at least one: choose others with --base-link and --tip-link"
        );
        return Err(error(&tree.source, message));
    }
    Ok(())
}

/// Names in backticks; if there are many, the first twelve.
fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut names = names.into_iter();
    let first: Vec<_> = names.by_ref().take(12).map(|name| format!("`{name}`")).collect();
    match names.count() {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}
