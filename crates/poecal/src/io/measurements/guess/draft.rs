//! What is chosen of a mapping, by a guess or by a person.

use std::collections::BTreeMap;

use crate::io::measurements::orientation::OrientationForm;
use crate::io::measurements::units::NamedUnit;
use crate::unit::Unit;

/// What is chosen.
#[derive(Default)]
pub(super) struct Draft {
    /// Joints, what they are measured in, and their columns.
    pub(super) joints: Vec<(String, Unit, Option<String>)>,
    pub(super) position: [Option<String>; 3],
    pub(super) form: Option<String>,
    pub(super) parts: Vec<Option<String>>,
    /// Units by the names of their fields; none where the file states them.
    pub(super) units: BTreeMap<&'static str, Option<NamedUnit>>,
    pub(super) is_inverted: bool,
    pub(super) target: Option<String>,
    pub(super) id: Option<String>,
    /// Columns with a name of ours that are not to be read.
    pub(super) left_out: Vec<String>,
}

impl Draft {
    pub(super) fn orientation(&self) -> Option<OrientationForm> {
        self.form.as_ref()?.parse().ok()
    }

    /// All columns that something is read from.
    pub(super) fn used(&self) -> impl Iterator<Item = &String> {
        let joints = self.joints.iter().map(|it| &it.2);
        let others = self.position.iter().chain(&self.parts).chain([&self.target, &self.id]);
        joints.chain(others).flatten()
    }
}
