//! What a person can choose of a mapping, as fields with what is chosen.

use serde::Serialize;

use super::draft::Draft;
use crate::table::orientation::OrientationForm;
use poecal_arm::lie::angles::{Angles, MAKERS};
use poecal_numerics::named_unit::units_of;
use poecal_numerics::unit::Unit;

/// A choice of a mapping: a column for what poecal reads, or one of some words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MappedField {
    /// What `--column` calls it.
    pub key: String,
    /// What it is part of: `joints`, `position`, `orientation` or `rows`.
    pub group: &'static str,
    /// What it is.
    pub label: String,
    /// The words to choose from; none where it is a column.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<MappedChoice>,
    /// The column or word; empty for none.
    pub chosen: String,
    /// Whether nothing can be read without it.
    pub required: bool,
}

/// Ways in which poses may point, as a mapping calls them.
pub(crate) const WAYS: [&str; 2] = ["device_from_target", "target_from_device"];

/// A word to choose.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MappedChoice {
    /// The word.
    pub value: String,
    /// What it means.
    pub text: String,
}

impl MappedChoice {
    fn new(value: &str, text: impl Into<String>) -> Self {
        MappedChoice { value: value.to_owned(), text: text.into() }
    }
}

/// The forms of an orientation, the most frequent first.
fn forms() -> Vec<MappedChoice> {
    let axes = (0..27).map(|it| [it / 9, it / 3 % 3, it % 3]).filter(|[a, b, c]| a != b && b != c);
    let angles = axes.clone().map(Angles::Intrinsic).chain(axes.map(Angles::Extrinsic));
    let angles = angles.filter(|it| *it != Angles::ROLL_PITCH_YAW).map(OrientationForm::Angles);
    let choice = |form: OrientationForm| {
        let own = MAKERS.iter().filter(|it| OrientationForm::Angles(it.angles) == form);
        let makers: Vec<String> = own.map(|it| format!("{} {}", it.maker, it.names.join(", "))).collect();
        let before = if makers.is_empty() { "" } else { ": " };
        MappedChoice::new(&form.mapped(), format!("{form}{before}{}", makers.join("; ")))
    };
    let none = MappedChoice::new("", "none: positions alone");
    std::iter::once(none).chain(OrientationForm::NAMED.into_iter().chain(angles).map(choice)).collect()
}

fn units(quantity: Unit) -> Vec<MappedChoice> {
    let stated = MappedChoice::new("", "as the file says, else SI");
    std::iter::once(stated)
        .chain(units_of(quantity).map(|unit| MappedChoice::new(unit.symbol(), unit.symbol())))
        .collect()
}

/// All fields of a draft.
pub(crate) fn fields(draft: &Draft) -> Vec<MappedField> {
    let of = |group, key: &str, label: &str, choices, chosen: Option<&str>, required| {
        let (key, label, chosen) = (key.to_owned(), label.to_owned(), chosen.unwrap_or_default().to_owned());
        MappedField { key, group, label, choices, chosen, required }
    };
    let column = |group, key: &str, label: &str, chosen: &Option<String>, required| {
        of(group, key, label, Vec::new(), chosen.as_deref(), required)
    };
    let unit = |group, key: &'static str, label: &str, quantity| {
        let chosen = draft.units.get(key).and_then(|it| it.map(|unit| unit.symbol()));
        of(group, &format!("unit.{key}"), label, units(quantity), chosen, false)
    };
    let mut found = Vec::new();
    found.extend(draft.joints.iter().map(|(name, _, it)| column("joints", name, name, it, true)));
    for (key, quantity, label) in
        [("angle", Unit::Radian, "unit of the angles"), ("length", Unit::Metre, "unit of the slides")]
    {
        if draft.joints.iter().any(|it| it.1 == quantity) {
            found.push(unit("joints", key, label, quantity));
        }
    }
    let axes = ["x", "y", "z"].into_iter().zip(&draft.position);
    found.extend(axes.map(|(axis, it)| column("position", axis, axis, it, true)));
    found.push(unit("position", "position", "unit", Unit::Metre));
    let chosen = draft.form.map(OrientationForm::mapped);
    found.push(of("orientation", "orientation", "form", forms(), chosen.as_deref(), false));
    if let Some(form) = draft.form {
        for (part, (name, it)) in form.part_names().iter().zip(&draft.parts).enumerate() {
            found.push(column("orientation", &format!("orientation.{}", part + 1), name, it, true));
        }
        if form.quantity() == Unit::Radian {
            found.push(unit("orientation", "orientation", "unit", Unit::Radian));
        }
        let [seen, seeing] = WAYS;
        let ways = vec![
            MappedChoice::new(seen, "of the target, as the device sees it"),
            MappedChoice::new(seeing, "of the device, as the target sees it"),
        ];
        let chosen = if draft.is_inverted { seeing } else { seen };
        found.push(of("orientation", "pose", "the poses are", ways, Some(chosen), false));
    }
    found.push(column("rows", "target", "name of the target", &draft.target, false));
    found.push(column("rows", "id", "name of the row", &draft.id, false));
    found
}
