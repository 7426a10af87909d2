//! Joints of a tree that no measurement involves.

use super::causes::ExplainedDirections;
use super::direction::Cause;

impl ExplainedDirections<'_> {
    /// Joints that no row's kinematic chain from instrument to target passes: no measurement depends on their screws.
    pub(crate) fn explain_unseen_joints(&mut self) {
        let count = self.excitation.seen_joints.len();
        let joints: Vec<usize> = (0..count).filter(|&joint| !self.excitation.seen_joints[joint]).collect();
        let directions = self.take(&self.screws(&joints));
        if directions == 0 {
            return;
        }
        let (what, them) = if joints.len() > 1 { ("joints", "them") } else { ("joint", "it") };
        let description = format!(
            "no measurement sees {what} {} move: no way from an instrument to its target passes {them}",
            self.names(&joints)
        );
        self.add(Cause::Unseen, &joints, directions, description);
    }
}
