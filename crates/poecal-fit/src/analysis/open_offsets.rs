//! Offsets of joints whose axes are held, where a free target, a free device or other free offsets have the same effect.

use nalgebra::DMatrix;

use super::direction::{Cause, Direction};
use super::setup::AnalysisSetup;
use super::subspace;
use crate::parameters::{Block, BlockNames, Parameter, ParameterSubject};
use poecal_model::robot::Term;

/// Share of an unknown (as a cosine) in directions without effect from which on it is not determined.
const OPEN: f64 = 0.01;
/// Singular value of exact directions above which knowing one quantity determines another.
const EXACT: f64 = 1e-5;

/// A joint, and the index of its offset in a step.
pub(crate) type OpenOffset = (usize, usize);

/// Offsets that are unknowns of their own, since the axes of their joints are held: each joint with the index of its offset in a step.
pub(crate) fn own_offsets(setup: &AnalysisSetup<'_>) -> Vec<OpenOffset> {
    let is_held = |joint: usize| {
        !setup
            .layout
            .parameters()
            .any(|(it, _)| it.value_term().is_none() && it.model().subject() == ParameterSubject::Joint(joint))
    };
    let offset = |(parameter, places): (&Parameter, &[(usize, f64)])| {
        let term = parameter.value_term().filter(|it| it.term == Term::OFFSET && is_held(it.joint))?;
        Some((term.joint, places.first()?.0))
    };
    setup.layout.parameters().filter_map(offset).collect()
}

/// Offsets that are not determined by directions without effect (orthonormal), grouped by the blocks that hide them, with the blocks to
/// hold.
pub(crate) fn open_offsets(setup: &AnalysisSetup<'_>, directions: &[Vec<f64>]) -> Vec<Direction> {
    let n = setup.layout.dim();
    if directions.is_empty() {
        return Vec::new();
    }
    let space = DMatrix::from_fn(n, directions.len(), |row, column| directions[column][row]);
    let is_open = |space: &DMatrix<f64>, place: usize| space.row(place).norm() > OPEN;
    let open: Vec<OpenOffset> = own_offsets(setup).into_iter().filter(|(_, place)| is_open(&space, *place)).collect();
    let mut groups: Vec<(Vec<Block>, Vec<OpenOffset>)> = Vec::new();
    for &(joint, place) in &open {
        let hidden = hiding_blocks(setup, &open, joint);
        let known = |blocks: &[Block]| subspace::without_beyond(&space, &units(setup, blocks), EXACT).0;
        let by = hidden.into_iter().find(|blocks| !is_open(&known(blocks), place));
        let by = by.unwrap_or_default();
        match groups.iter_mut().find(|(known, _)| *known == by) {
            Some((_, joints)) => joints.push((joint, place)),
            None => groups.push((by, vec![(joint, place)])),
        }
    }
    let mut left = space;
    let mut found = Vec::new();
    for (by, joints) in &groups {
        let own: Vec<Vec<f64>> = joints.iter().map(|(_, place)| unit(n, *place)).collect();
        let (rest, taken) = subspace::without_beyond(&left, &own, OPEN);
        left = rest;
        found.push(direction(setup, by, joints, taken));
    }
    found
}

/// Blocks that may hide the offset of a joint, the simplest first.
fn hiding_blocks(setup: &AnalysisSetup<'_>, open: &[OpenOffset], joint: usize) -> Vec<Vec<Block>> {
    let of = |wanted: &dyn Fn(Block) -> bool| -> Vec<Block> {
        setup.layout.parameters().map(|(it, _)| it.block()).filter(|it| wanted(*it)).collect()
    };
    let frames = of(&|it| matches!(it, Block::Frame(_)));
    let targets = of(&|it| matches!(it, Block::Target(_)));
    let others: Vec<Block> =
        open.iter().filter(|(other, _)| *other != joint).map(|(other, _)| Block::Term(*other, Term::OFFSET)).collect();
    let both = [frames.clone(), targets.clone()].concat();
    let mut sets = vec![frames, targets, both];
    sets.extend(others.iter().map(|it| vec![*it]));
    sets.push(others);
    sets.retain(|it| !it.is_empty());
    sets
}

/// Unit vectors of the unknowns of some blocks.
fn units(setup: &AnalysisSetup<'_>, blocks: &[Block]) -> Vec<Vec<f64>> {
    let n = setup.layout.dim();
    let own = setup.layout.parameters().filter(|(it, _)| blocks.contains(&it.block()));
    own.flat_map(|(_, places)| places.iter().map(|(place, _)| unit(n, *place))).collect()
}

/// Unit vector of an unknown.
fn unit(n: usize, place: usize) -> Vec<f64> {
    (0..n).map(|k| f64::from(u8::from(k == place))).collect()
}

/// The description of offsets that some blocks hide.
fn direction(setup: &AnalysisSetup<'_>, by: &[Block], joints: &[OpenOffset], directions: usize) -> Direction {
    let session = &setup.session;
    let all = BlockNames {
        joints: session.robot.joints.iter().map(|it| it.name.clone()).collect(),
        targets: session.data.targets.clone(),
        stations: session.data.stations.clone(),
    };
    let zeros: Vec<String> =
        joints.iter().map(|(joint, _)| all.name_of_block(Block::Term(*joint, Term::OFFSET))).collect();
    let hidden: Vec<String> = by.iter().map(|it| all.name_of_block(*it)).collect();
    let has = |wanted: &dyn Fn(&Block) -> bool| by.iter().any(wanted);
    let frame = has(&|it| matches!(it, Block::Frame(_))).then_some("the place of the device");
    let target = has(&|it| matches!(it, Block::Target(_))).then_some("the place of the target");
    let what: Vec<&str> = [frame, target].into_iter().flatten().collect();
    let what = if what.is_empty() { hidden.join(" and ") } else { what.join(" and ") };
    let held: Vec<String> = hidden.iter().map(|name| format!("--fix {name}")).collect();
    let description = if by.is_empty() {
        format!(
            "{}: other unknowns have the same effect: hold the device and the target (--fix frames --fix targets), or these zeros",
            zeros.join(" and ")
        )
    } else {
        format!(
            "{} and {what} can change together: hold what has not moved ({}), where the calibration.json that is the model has it, or free fewer zeros",
            zeros.join(" and "),
            held.join(" ")
        )
    };
    let joints = joints.iter().filter_map(|(joint, _)| session.robot.joints.get(*joint));
    Direction {
        description,
        joints: joints.map(|it| it.name.clone()).collect(),
        cause: Cause::JointOffsets,
        directions,
    }
}
