//! Blocks of unknowns and their names.

use crate::state::{ClockTerm, RangeTerm};
use poecal_model::robot::{MEASURED, Term};

use super::{Parameter, ParameterSubject};

/// A block of unknowns, which a fit changes or holds as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// Axis (or direction) of a joint.
    Axis(usize),
    /// Term of a joint's value.
    Term(usize, Term),
    /// A target.
    Target(usize),
    /// Frame of an instrument.
    Frame(usize),
    /// Term of an instrument's range.
    Range(usize, RangeTerm),
    /// Term of an instrument's clock.
    Clock(usize, ClockTerm),
}

/// Names of joints, targets and instruments, from which blocks and unknowns derive theirs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockNames {
    /// Joints.
    pub joints: Vec<String>,
    /// Targets; the only one may have no name.
    pub targets: Vec<Option<String>>,
    /// Instruments; a single one may have no name.
    pub stations: Vec<Option<String>>,
}

impl BlockNames {
    /// All blocks: of each joint the axis and its terms, then the targets, the frames, the terms of ranges, and the clocks.
    #[must_use]
    pub fn blocks(&self) -> Vec<Block> {
        let joints = (0..self.joints.len()).flat_map(|joint| {
            let terms = Term::unnumbered().map(move |term| Block::Term(joint, term));
            std::iter::once(Block::Axis(joint)).chain(terms)
        });
        let targets = (0..self.targets.len()).map(Block::Target);
        let frames = (0..self.stations.len().max(1)).map(Block::Frame);
        let ranges =
            (0..self.stations.len().max(1)).flat_map(|station| RangeTerm::ALL.map(|term| Block::Range(station, term)));
        let clocks =
            (0..self.stations.len().max(1)).flat_map(|station| ClockTerm::ALL.map(|term| Block::Clock(station, term)));
        joints.chain(targets).chain(frames).chain(ranges).chain(clocks).collect()
    }

    /// Name of a block: `JOINT.axis`, `JOINT.TERM`, `target.NAME`, `frame.NAME`, `zero.NAME`, `scale.NAME`, `lag.NAME`, `drift.NAME`. It is `target`
    /// for [`MEASURED`], and `frame`, `zero`, `scale`, `lag`, `drift` for a single instrument.
    #[must_use]
    pub fn name_of_block(&self, block: Block) -> String {
        let joint = |joint: usize| self.joints.get(joint).map_or("", String::as_str);
        let among = |kind: &str, names: &[Option<String>], at: usize| match names.get(at) {
            Some(Some(name)) => format!("{kind}.{name}"),
            Some(None) | None => kind.to_owned(),
        };
        match block {
            Block::Axis(at) => format!("{}.axis", joint(at)),
            Block::Term(at, term) => format!("{}.{}", joint(at), term),
            Block::Target(at) if self.targets.get(at).is_some_and(|it| it.as_deref() == Some(MEASURED)) => {
                "target".to_owned()
            }
            Block::Target(at) => among("target", &self.targets, at),
            Block::Frame(at) => among("frame", &self.stations, at),
            Block::Range(at, term) => among(term.name(), &self.stations, at),
            Block::Clock(at, term) => among(term.name(), &self.stations, at),
        }
    }

    /// Names of the unknowns of a parameter, in its order.
    #[must_use]
    pub fn of_unknowns(&self, parameter: &Parameter) -> Vec<String> {
        let block = self.name_of_block(parameter.block());
        let columns = parameter.model().columns().iter();
        let name = |name: &str| if name.is_empty() { block.clone() } else { format!("{block}.{name}") };
        columns.map(|column| name(column.name)).collect()
    }
}

impl Parameter {
    /// Block of the parameter.
    #[must_use]
    pub fn block(&self) -> Block {
        match (self.model().subject(), self.value_term()) {
            (ParameterSubject::Joint(joint), Some(term)) => Block::Term(joint, term.term),
            (ParameterSubject::Joint(joint), None) => Block::Axis(joint),
            (ParameterSubject::Target(target), _) => Block::Target(target),
            (ParameterSubject::Instrument(station), _) => Block::Frame(station),
            (ParameterSubject::Clock(station), _) => {
                let lag = ClockTerm::Lag;
                Block::Clock(station, if let Parameter::ClockUnknown(it) = self { it.term } else { lag })
            }
            (ParameterSubject::Range(station), _) => {
                let zero = RangeTerm::Zero;
                Block::Range(station, if let Parameter::RangeUnknown(it) = self { it.term } else { zero })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::TargetPlace;

    #[test]
    fn blocks_have_the_names_of_what_they_are_of() {
        let names = BlockNames {
            joints: vec!["elbow".to_owned()],
            targets: vec![None, Some("ball".to_owned()), Some(MEASURED.to_owned())],
            stations: vec![Some("left".to_owned())],
        };
        let ball = Parameter::TargetPlace(TargetPlace { target: 1 });
        assert_eq!(ball.block(), Block::Target(1));
        for (block, name) in [
            (Block::Axis(0), "elbow.axis"),
            (Block::Target(0), "target"),
            (Block::Target(2), "target"),
            (ball.block(), "target.ball"),
            (Block::Frame(0), "frame.left"),
        ] {
            assert_eq!(names.name_of_block(block), name);
        }
    }
}
