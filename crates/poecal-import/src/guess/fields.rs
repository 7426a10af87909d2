//! What a person can choose of a mapping, as fields with what is chosen.

use serde::Serialize;

use super::draft::Draft;
use crate::table::orientation::OrientationForm;
use poecal_arm::lie::angles::MAKERS;
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

/// Forms that are not three angles about axes, and the most frequent first.
const FORMS: [&str; 6] = [
    "quaternion_xyzw",
    "quaternion_wxyz",
    "rotation_vector",
    "roll_pitch_yaw",
    "rotation_matrix",
    "rotation_matrix_by_columns",
];

/// The forms of an orientation.
fn forms() -> Vec<MappedChoice> {
    let axes = || "xyz".chars();
    let turns = axes().flat_map(|a| axes().flat_map(move |b| axes().map(move |c| format!("{a}{b}{c}"))));
    let turns: Vec<String> = turns.collect();
    let angles = ["intrinsic_", "extrinsic_"]
        .into_iter()
        .flat_map(|kind| turns.iter().map(move |it| format!("{kind}{it}")));
    let words = FORMS.into_iter().map(str::to_owned).chain(angles.filter(|it| it != "extrinsic_xyz"));
    let choice = |word: String| {
        let form: OrientationForm = word.parse().ok()?;
        let own = MAKERS.iter().filter(|it| OrientationForm::Angles(it.angles) == form);
        let makers: Vec<String> = own.map(|it| format!("{} {}", it.maker, it.names.join(", "))).collect();
        let before = if makers.is_empty() { "" } else { ": " };
        Some(MappedChoice::new(&word, format!("{form}{before}{}", makers.join("; "))))
    };
    std::iter::once(MappedChoice::new("", "none: positions alone")).chain(words.filter_map(choice)).collect()
}

fn units(quantity: Unit) -> Vec<MappedChoice> {
    let stated = MappedChoice::new("", "as the file says, else SI");
    std::iter::once(stated)
        .chain(units_of(quantity).map(|unit| MappedChoice::new(unit.symbol(), unit.symbol())))
        .collect()
}

/// All fields of a draft.
pub(crate) fn fields(draft: &Draft) -> Vec<MappedField> {
    let mut found = Vec::new();
    let mut field =
        |group, key: &str, label: &str, choices: Vec<MappedChoice>, chosen: Option<&str>, required| {
            let (key, label, chosen) =
                (key.to_owned(), label.to_owned(), chosen.unwrap_or_default().to_owned());
            found.push(MappedField { key, group, label, choices, chosen, required });
        };
    let unit = |key: &str| draft.units.get(key).and_then(|it| it.map(|unit| unit.symbol()));
    for (name, _, column) in &draft.joints {
        field("joints", name, name, Vec::new(), column.as_deref(), true);
    }
    for (key, quantity, label) in
        [("angle", Unit::Radian, "unit of the angles"), ("length", Unit::Metre, "unit of the slides")]
    {
        if draft.joints.iter().any(|it| it.1 == quantity) {
            field("joints", &format!("unit.{key}"), label, units(quantity), unit(key), false);
        }
    }
    for (axis, column) in ["x", "y", "z"].into_iter().zip(&draft.position) {
        field("position", axis, axis, Vec::new(), column.as_deref(), true);
    }
    field("position", "unit.position", "unit", units(Unit::Metre), unit("position"), false);
    field("orientation", "orientation", "form", forms(), draft.form.as_deref(), false);
    if let Some(form) = draft.orientation() {
        for (part, (name, column)) in form.part_names().iter().zip(&draft.parts).enumerate() {
            field(
                "orientation",
                &format!("orientation.{}", part + 1),
                name,
                Vec::new(),
                column.as_deref(),
                true,
            );
        }
        if form.quantity() == Unit::Radian {
            field("orientation", "unit.orientation", "unit", units(Unit::Radian), unit("orientation"), false);
        }
        let ways = vec![
            MappedChoice::new("device_from_target", "of the target, as the device sees it"),
            MappedChoice::new("target_from_device", "of the device, as the target sees it"),
        ];
        let chosen = if draft.is_inverted { "target_from_device" } else { "device_from_target" };
        field("orientation", "pose", "the poses are", ways, Some(chosen), false);
    }
    field("rows", "target", "name of the target", Vec::new(), draft.target.as_deref(), false);
    field("rows", "id", "name of the row", Vec::new(), draft.id.as_deref(), false);
    found
}
