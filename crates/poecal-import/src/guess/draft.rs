//! What is chosen of a mapping, by a guess or by a person.

use std::collections::BTreeMap;

use crate::table::orientation::OrientationForm;
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// What is chosen.
#[derive(Default)]
pub(crate) struct Draft {
    /// Joints, what they are measured in, and their columns.
    pub(crate) joints: Vec<(String, Unit, Option<String>)>,
    pub(crate) position: [Option<String>; 3],
    pub(crate) form: Option<OrientationForm>,
    pub(crate) parts: Vec<Option<String>>,
    /// Units by the names of their fields; none where the file states them.
    pub(crate) units: BTreeMap<&'static str, Option<NamedUnit>>,
    pub(crate) is_inverted: bool,
    pub(crate) target: Option<String>,
    pub(crate) id: Option<String>,
    /// Columns with a name of ours that are not to be read.
    pub(crate) left_out: Vec<String>,
}

impl Draft {
    /// All columns that something is read from.
    pub(crate) fn used(&self) -> impl Iterator<Item = &String> {
        let joints = self.joints.iter().map(|it| &it.2);
        let others = self.position.iter().chain(&self.parts).chain([&self.target, &self.id]);
        joints.chain(others).flatten()
    }
}
