//! Choice of the unknowns of a fit, by names of blocks.

use wildmatch::WildMatch;

use poecal_fit::parameters::{Block, BlockNames};
use poecal_fit::state::Unknowns;
use poecal_model::camera::{PictureUnknown, Pictures, is_flat_sheet};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Gravity, GravityDirection, JointTerm, Robot, Statics, Term, TermArgument};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Blocks that a message lists at most.
const LISTED: usize = 12;

/// Deviations of a fit's unknowns from the default: first the blocks of `fix` are held as in the model, then those of `free` are unknown. A word is a
/// block's name ([`BlockNames::name_of_block`]), in which `*` and `?` stand for any letters and any letter; a joint's name, which means its axis; or one of `joints`
/// (all axes), `targets` and `frames`. Further terms are unknown only by their exact names: harmonics (`joint2.sin1`), couplings (`joint3.coupled2`
/// is the motion of joint3 by the second joint), and terms of weights or factors (`joint2.masses`).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockChoice {
    /// Words for unknown blocks.
    pub free: Vec<String>,
    /// Words for held blocks.
    pub fix: Vec<String>,
}

/// Names of a robot's joints, and of the targets and instruments of its measurements.
pub fn names(robot: &Robot, data: &Dataset) -> BlockNames {
    BlockNames {
        joints: robot.joints.iter().map(|joint| joint.name.clone()).collect(),
        targets: data.targets.clone(),
        stations: data.stations.clone(),
    }
}

/// The blocks of a session; clocks only of instruments that measured in motion.
fn blocks(names: &BlockNames, data: &Dataset) -> Vec<Block> {
    let is_there = |block: &Block| match block {
        Block::Clock(station, _) => data.moving.clock(*station).is_some(),
        Block::Axis(_) | Block::Target(_) | Block::Frame(_) | Block::Term(..) | Block::Range(..) => true,
    };
    names.blocks().into_iter().filter(is_there).collect()
}

impl BlockChoice {
    /// The robot with the additional arguments of the freed terms beside joint values: gravity in this direction, and these terms themselves.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if the robot has no such masses, weights or factors, or gravity is unknown.
    pub(crate) fn with_terms(&self, robot: Robot, data: &Dataset, gravity: GravityDirection) -> Result<Robot> {
        let names = names(&robot, data);
        let mut found = robot;
        for word in &self.free {
            let needs_more = |it: &(usize, Term)| it.1.needs_gravity() || it.1.argument() == TermArgument::Factor;
            let Some((joint, term)) = further_term(&names, word).filter(needs_more) else { continue };
            if term.needs_gravity() && found.gravity.is_none() {
                let GravityDirection::Known(direction) = gravity else {
                    return ErrorKind::Option
                        .refuse(format!("found `{word}` to be fitted, expected a known direction of gravity"));
                };
                found.gravity = Some(Gravity::of_unit_weights(&found, direction));
            }
            let is_pulled =
                !term.needs_gravity() || Statics::new(&found).is_some_and(|statics| statics.is_pulled(joint, term));
            let carried = || (!is_pulled).then(|| "one of what the joint carries".to_owned());
            if let Some(needed) = found.lacks(term).or_else(carried) {
                return ErrorKind::Option.refuse(format!("found `{word}` to be fitted, expected {needed}"));
            }
            if !found.terms.iter().any(|it| (it.joint, it.term) == (joint, term)) {
                found.terms.push(JointTerm { joint, term, coefficient: 0.0 });
            }
        }
        Ok(found)
    }

    /// The unknowns of a fit.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if a word names no block, or nothing is unknown.
    pub fn unknowns(&self, robot: &Robot, data: &Dataset) -> Result<Unknowns> {
        let names = names(robot, data);
        let blocks = blocks(&names, data);
        let usual = |block: &Block| !matches!(block, Block::Term(..) | Block::Range(..));
        let mut is_free: Vec<bool> = blocks.iter().map(usual).collect();
        let (mut further, mut pictures) = (Vec::new(), Vec::new());
        for (words, value) in [(&self.fix, false), (&self.free, true)] {
            for word in words {
                let chosen = match_blocks(&names, &blocks, word);
                if let Some(term) = further_term(&names, word).filter(|_| value && !chosen.contains(&true)) {
                    further.push(term);
                    continue;
                }
                let seen = picture_unknowns(data, word);
                if value && !chosen.contains(&true) && !seen.is_empty() {
                    refuse_bodies(data, word, &seen)?;
                    pictures.extend(seen);
                    continue;
                }
                if !chosen.contains(&true) {
                    return Err(unknown_word(&names, &blocks, word));
                }
                chosen.iter().zip(&mut is_free).filter(|it| *it.0).for_each(|(_, is_free)| *is_free = value);
            }
        }
        let mut unknowns = Unknowns::default();
        unknowns.open_targets.extend(self.open_targets(&names, &blocks));
        sort_blocks(&mut unknowns, blocks.into_iter().zip(&is_free), (&names, data))?;
        further.sort_unstable();
        further.dedup();
        let is_any = !further.is_empty() || is_free.contains(&true);
        unknowns.terms.extend(further);
        // A guessed lens is unknown without being named.
        let guessed = data.pictures.cameras.iter().enumerate().filter(|(_, camera)| camera.is_guessed);
        pictures.extend(guessed.map(|(at, _)| PictureUnknown::Lens(at)));
        pictures.sort_unstable();
        pictures.dedup();
        unknowns.pictures = pictures;
        if !is_any {
            return ErrorKind::Option
                .refuse("found that every block is held, expected at least one that is unknown: fix fewer");
        }
        Ok(unknowns)
    }

    /// Named targets, which are unknown regardless of their positions in the model; a star that means everything includes targets only incidentally.
    fn open_targets(&self, names: &BlockNames, blocks: &[Block]) -> Vec<usize> {
        let mut open = Vec::new();
        for word in &self.free {
            let meant = || blocks.iter().zip(match_blocks(names, blocks, word)).filter(|it| it.1);
            if meant().all(|(block, _)| matches!(block, Block::Target(_))) {
                open.extend(meant().filter_map(|(block, _)| match block {
                    Block::Target(target) => Some(*target),
                    Block::Axis(_) | Block::Frame(_) | Block::Term(..) | Block::Range(..) | Block::Clock(..) => None,
                }));
            }
        }
        open
    }
}

/// Refuses frames that are to be fitted although measurements are in the base frame.
pub(crate) fn refuse_frames(choice: &BlockChoice, robot: &Robot, data: &Dataset) -> Result<()> {
    let names = names(robot, data);
    let blocks = names.blocks();
    let frees = |word: &&String| {
        let chosen = match_blocks(&names, &blocks, word);
        // A star that means everything includes frames only incidentally.
        let others = chosen.iter().zip(&blocks).any(|(is, block)| *is && !matches!(block, Block::Frame(_)));
        !others && chosen.contains(&true)
    };
    match choice.free.iter().find(frees) {
        Some(word) => {
            ErrorKind::Option.refuse(format!(
                "found `{word}` to be fitted beside measurements in the base frame (--device-frame base), expected one of the two: leave one out"
            ))
        }
        None => Ok(()),
    }
}

/// Refuses the shape of a body that is no flat sheet.
fn refuse_bodies(data: &Dataset, word: &str, seen: &[PictureUnknown]) -> Result<()> {
    let board = |it: &PictureUnknown| match it {
        PictureUnknown::Board(at) => data.pictures.boards.get(*at),
        PictureUnknown::Lens(_) | PictureUnknown::Markers(_) => None,
    };
    match seen.iter().filter_map(board).find(|board| !is_flat_sheet(board)) {
        Some(board) => ErrorKind::Option.refuse(format!(
            "found `{word}` to be fitted, but the points of `{}` are not in one plane of its x and y, expected a flat board: free its points \
             (--free markers)",
            board.name
        )),
        None => Ok(()),
    }
}

/// Unknowns of the cameras and boards of a session's pictures that a word frees: `lens`, `board`, `markers`, or one of these of a name.
fn picture_unknowns(data: &Dataset, word: &str) -> Vec<PictureUnknown> {
    let Pictures { cameras, boards, .. } = &data.pictures;
    let (kind, name) = word.split_once('.').map_or((word, None), |(kind, name)| (kind, Some(name)));
    let is_meant = |own: &str| name.is_none_or(|name| WildMatch::new(name).matches(own));
    let of_boards = |unknown: fn(usize) -> PictureUnknown| -> Vec<PictureUnknown> {
        let own = boards.iter().enumerate().filter(|(_, board)| is_meant(&board.name));
        own.map(|(at, _)| unknown(at)).collect()
    };
    match kind {
        "lens" => {
            let own = cameras.iter().enumerate().filter(|(_, camera)| is_meant(&camera.name));
            own.map(|(at, _)| PictureUnknown::Lens(at)).collect()
        }
        "board" => of_boards(PictureUnknown::Board),
        "markers" => of_boards(PictureUnknown::Markers),
        _ => Vec::new(),
    }
}

/// A term by its exact name that is a block only on request.
fn further_term(names: &BlockNames, word: &str) -> Option<(usize, Term)> {
    let (joint, term) = word.rsplit_once('.')?;
    let joint = names.joints.iter().position(|name| name == joint)?;
    let term: Term = term.parse().ok()?;
    let is_other = term.argument() != TermArgument::OtherJoint || term.index() != joint;
    (is_other && term.is_of(names.joints.len(), usize::MAX)).then_some((joint, term))
}

/// Marks each block that a word means.
fn match_blocks(names: &BlockNames, blocks: &[Block], word: &str) -> Vec<bool> {
    let pattern = WildMatch::new(word);
    let is_meant = |block: &Block| match (word, block) {
        ("joints", Block::Axis(_)) | ("targets", Block::Target(_)) | ("frames", Block::Frame(_)) => true,
        (_, Block::Axis(joint)) => {
            let is_joint = names.joints.get(*joint).is_some_and(|name| name == word);
            is_joint && !["targets", "frames"].contains(&word) || pattern.matches(&names.name_of_block(*block))
        }
        // The name of the term alone means the blocks of all instruments.
        (_, Block::Range(_, term)) => {
            word == term.name() || word != "*" && pattern.matches(&names.name_of_block(*block))
        }
        (_, Block::Clock(_, term)) => {
            word == term.name() || word != "*" && pattern.matches(&names.name_of_block(*block))
        }
        (_, Block::Term(..) | Block::Target(_) | Block::Frame(_)) => pattern.matches(&names.name_of_block(*block)),
    };
    blocks.iter().map(is_meant).collect()
}

fn no_range(name: &str) -> Error {
    ErrorKind::Option
        .error(format!("found `{name}` to be fitted, expected an instrument that measures distances alone"))
}

fn unknown_word(names: &BlockNames, blocks: &[Block], word: &str) -> Error {
    let mut listed: Vec<String> = blocks.iter().take(LISTED).map(|block| names.name_of_block(*block)).collect();
    if blocks.len() > LISTED {
        let last = blocks.last().map(|block| names.name_of_block(*block));
        listed.push("…".to_owned());
        listed.extend(last);
    }
    ErrorKind::Option.error(format!(
        "found `{word}`, expected what to free or fix: joints, targets, frames, of pictures also lens, board or markers to free, or a block's name, in \
         which `*` stands for any letters ({})",
        listed.join(", ")
    ))
}

/// Sorts blocks that are unknown (or held) into the unknowns of a fit.
fn sort_blocks<'a>(
    unknowns: &mut Unknowns,
    blocks: impl Iterator<Item = (Block, &'a bool)>,
    (names, data): (&BlockNames, &Dataset),
) -> Result<()> {
    for (block, is_free) in blocks {
        match block {
            Block::Axis(joint) if !is_free => unknowns.held_axes.push(joint),
            Block::Target(target) if !is_free => unknowns.held_targets.push(target),
            Block::Frame(station) if !is_free => unknowns.held_frames.push(station),
            Block::Term(joint, term) if *is_free => unknowns.terms.push((joint, term)),
            Block::Range(station, term) if *is_free => {
                if !data.is_ranging(station) {
                    return Err(no_range(&names.name_of_block(block)));
                }
                unknowns.ranges.push((station, term));
            }
            Block::Clock(station, term) if !is_free => unknowns.held_clocks.push((station, term)),
            Block::Axis(_)
            | Block::Target(_)
            | Block::Frame(_)
            | Block::Term(..)
            | Block::Range(..)
            | Block::Clock(..) => {}
        }
    }
    Ok(())
}
