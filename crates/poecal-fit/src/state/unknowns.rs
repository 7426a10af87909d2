//! Which parts of a session are unknown.

use super::{ClockTerm, RangeTerm};
use poecal_model::camera::PictureUnknown;
use poecal_model::robot::Term;

/// What a fit changes: the axes of all joints, all targets and all frames of instruments, but for what is held as in the model; and terms of
/// joint values, of which none is unknown without being named.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unknowns {
    /// Joints whose axes are held.
    pub held_axes: Vec<usize>,
    /// Targets that are held.
    pub held_targets: Vec<usize>,
    /// Targets of whose places nothing is known before: no prior (theory.md §6 (27c)).
    pub open_targets: Vec<usize>,
    /// Prior standard deviation of the places of the other targets that move with the robot, metres; `None` is the widest of (27c).
    pub target_sigma_m: Option<f64>,
    /// Stations whose frames are held.
    pub held_frames: Vec<usize>,
    /// Terms of joint values that are unknown.
    pub terms: Vec<(usize, Term)>,
    /// Zeros and scales of stations that are unknown beside those of which the rows say so.
    pub ranges: Vec<(usize, RangeTerm)>,
    /// Lags and drifts of the clocks of stations that are held.
    pub held_clocks: Vec<(usize, ClockTerm)>,
    /// What of cameras and boards is unknown.
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

    /// Whether those of the robot, its targets and instruments are the usual ones; what is known of them before is another question.
    #[must_use]
    pub fn are_usual(&self) -> bool {
        Unknowns { open_targets: Vec::new(), target_sigma_m: None, pictures: Vec::new(), ..self.clone() }
            == Unknowns::USUAL
    }

    /// Whether the axis of a joint is unknown.
    #[must_use]
    pub fn moves_axis(&self, joint: usize) -> bool {
        !self.held_axes.contains(&joint)
    }

    /// Whether a target is unknown.
    #[must_use]
    pub fn moves_target(&self, target: usize) -> bool {
        !self.held_targets.contains(&target)
    }

    /// Whether the frame of a station is unknown.
    #[must_use]
    pub fn moves_frame(&self, station: usize) -> bool {
        !self.held_frames.contains(&station)
    }

    /// Whether the axis or a term of any of so many joints is unknown.
    #[must_use]
    pub fn moves_joints(&self, joints: usize) -> bool {
        !self.terms.is_empty() || (0..joints).any(|joint| self.moves_axis(joint))
    }

    /// Whether nothing stands in the base frame, so that any motion of it is one of the device (theory.md §8 (37)).
    #[must_use]
    pub fn base_is_free(&self) -> bool {
        self.held_axes.is_empty() && self.held_targets.is_empty() && self.held_frames.is_empty()
    }
}

/// The usual unknowns, to refer to.
pub(crate) static USUAL: Unknowns = Unknowns::USUAL;
