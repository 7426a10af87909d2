//! Unknowns of a session.

use super::{ClockTerm, RangeTerm};
use poecal_model::camera::PictureUnknown;
use poecal_model::robot::Term;

/// Unknowns of a fit: the axes of all joints, all targets and all frames of instruments, except those that are held as in the model. A term
/// of joint values is unknown only if it is named.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unknowns {
    /// Joints whose axes are held.
    pub held_axes: Vec<usize>,
    /// Targets that are held.
    pub held_targets: Vec<usize>,
    /// Targets without prior knowledge of their positions: no prior (theory.md §6 (27c)).
    pub open_targets: Vec<usize>,
    /// Prior standard deviation of the positions of the other targets that move with the robot, metres; `None` is the widest of (27c).
    pub target_sigma_m: Option<f64>,
    /// Stations whose frames are held.
    pub held_frames: Vec<usize>,
    /// Terms of joint values that are unknown.
    pub terms: Vec<(usize, Term)>,
    /// Zeros and scales of stations that are unknown, beside those that the rows state as unknown.
    pub ranges: Vec<(usize, RangeTerm)>,
    /// Lags and drifts of the clocks of stations that are held.
    pub held_clocks: Vec<(usize, ClockTerm)>,
    /// Unknowns of cameras and boards.
    pub pictures: Vec<PictureUnknown>,
}

impl Unknowns {
    /// All axes, targets and frames, and no term.
    pub const USUAL: Unknowns = Unknowns {
        held_axes: Vec::new(),
        held_targets: Vec::new(),
        open_targets: Vec::new(),
        target_sigma_m: None,
        held_frames: Vec::new(),
        terms: Vec::new(),
        ranges: Vec::new(),
        held_clocks: Vec::new(),
        pictures: Vec::new(),
    };

    /// True if those of the robot, its targets and instruments are the usual ones; prior knowledge of them does not count.
    #[must_use]
    pub fn are_usual(&self) -> bool {
        Unknowns { open_targets: Vec::new(), target_sigma_m: None, pictures: Vec::new(), ..self.clone() }
            == Unknowns::USUAL
    }

    /// True if the axis of a joint is unknown.
    #[must_use]
    pub fn moves_axis(&self, joint: usize) -> bool {
        !self.held_axes.contains(&joint)
    }

    /// True if a target is unknown.
    #[must_use]
    pub fn moves_target(&self, target: usize) -> bool {
        !self.held_targets.contains(&target)
    }

    /// True if the frame of a station is unknown.
    #[must_use]
    pub fn moves_frame(&self, station: usize) -> bool {
        !self.held_frames.contains(&station)
    }

    /// True if the axis or a term of any of the first `joints` joints is unknown.
    #[must_use]
    pub fn moves_joints(&self, joints: usize) -> bool {
        !self.terms.is_empty() || (0..joints).any(|joint| self.moves_axis(joint))
    }

    /// True if nothing is held in the base frame, so that any motion of it is one of the device (theory.md §8 (37)).
    #[must_use]
    pub fn base_is_free(&self) -> bool {
        self.held_axes.is_empty() && self.held_targets.is_empty() && self.held_frames.is_empty()
    }
}

/// The usual unknowns, for references.
pub(crate) static USUAL: Unknowns = Unknowns::USUAL;
