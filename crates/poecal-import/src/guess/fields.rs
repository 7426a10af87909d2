//! Fields of a mapping that a person can choose, with the present choice.

use serde::Serialize;

use crate::table::orientation::OrientationForm;
use poecal_arm::lie::angles::{Angles, MAKERS};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::{NamedUnit, units_of};
use poecal_numerics::unit::Unit;

/// A choice of a mapping: a column for an input of poecal, or one of some words.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MappedField {
    /// Key of the field, as `--column` takes it.
    pub key: String,
    /// Group of the field: `joints`, `position`, `orientation` or `rows`.
    pub group: &'static str,
    /// Label of the field.
    pub label: String,
    /// Words to choose from; empty if the field is a column.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<MappedChoice>,
    /// The column or word; empty for none.
    pub chosen: String,
    /// True if nothing can be read without it.
    pub required: bool,
    /// The key of the field with the unit of this column; empty for none.
    #[serde(skip)]
    pub(crate) unit: &'static str,
}

/// A word to choose.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MappedChoice {
    /// The word.
    pub value: String,
    /// Meaning of the word.
    pub text: String,
}

impl MappedChoice {
    fn new(value: &str, text: impl Into<String>) -> Self {
        MappedChoice { value: value.to_owned(), text: text.into() }
    }
}

/// Unit of some columns: its field, and the usual units up to a number and beyond it.
pub(crate) struct UnitField {
    pub(crate) key: &'static str,
    pub(crate) of: Unit,
    pub(crate) most: f64,
    pub(crate) usual: [&'static str; 2],
}

const fn unit(key: &'static str, of: Unit, most: f64, usual: [&'static str; 2]) -> UnitField {
    UnitField { key, of, most, usual }
}

/// Largest angle that is taken as radians; larger ones are degrees, since joints turn once to either side.
pub(crate) const MOST_RADIANS: f64 = 7.0;
/// Units of joint angles, slides, positions and angles of orientations; robots reach less than 20 m.
pub(crate) const UNITS: [UnitField; 4] = [
    unit("unit.angle", Unit::Radian, MOST_RADIANS, ["rad", "deg"]),
    unit("unit.length", Unit::Metre, 10.0, ["m", "mm"]),
    unit("unit.position", Unit::Metre, 20.0, ["m", "mm"]),
    unit("unit.orientation", Unit::Radian, MOST_RADIANS, ["rad", "deg"]),
];
/// Directions in which poses may point, in the words of a mapping.
pub(crate) const WAYS: [&str; 2] = ["device_from_target", "target_from_device"];

impl MappedField {
    /// A field for a column.
    pub(crate) fn column(group: &'static str, key: &str, label: &str, column: Option<String>) -> Self {
        let (key, label, chosen) = (key.to_owned(), label.to_owned(), column.unwrap_or_default());
        MappedField { key, group, label, chosen, ..MappedField::default() }
    }

    /// Requires the column, and states the field of its unit.
    pub(crate) fn of_number(self, unit: &'static str) -> Self {
        MappedField { required: true, unit, ..self }
    }

    /// A field for the unit of columns.
    pub(crate) fn unit(group: &'static str, key: &str, label: &str) -> Self {
        let quantity = UNITS.iter().find(|it| it.key == key).map_or(Unit::One, |it| it.of);
        let stated = MappedChoice::new("", "as the file states, else SI");
        let units = units_of(quantity).map(|unit| MappedChoice::new(unit.symbol(), unit.symbol()));
        let choices = std::iter::once(stated).chain(units).collect();
        MappedField { choices, ..MappedField::column(group, key, label, None) }
    }

    /// The field for the form of an orientation.
    pub(crate) fn form(form: Option<OrientationForm>) -> Self {
        let chosen = form.map(OrientationForm::mapping_text);
        let choices = forms();
        MappedField { choices, ..MappedField::column("orientation", "orientation", "form", chosen) }
    }

    /// A field for the direction in which poses point.
    pub(crate) fn way() -> Self {
        let texts = ["of the target, as the device sees it", "of the device, as the target sees it"];
        let choices = WAYS.into_iter().zip(texts).map(|(way, text)| MappedChoice::new(way, text)).collect();
        let chosen = Some(WAYS[0].to_owned());
        MappedField { choices, ..MappedField::column("orientation", "pose", "the poses are", chosen) }
    }

    /// The column that is chosen.
    pub(crate) fn chosen_column(&self) -> Option<&String> {
        Some(&self.chosen).filter(|it| self.choices.is_empty() && !it.is_empty())
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
        MappedChoice::new(&form.mapping_text(), format!("{form}{before}{}", makers.join("; ")))
    };
    let none = MappedChoice::new("", "none: positions alone");
    std::iter::once(none).chain(OrientationForm::with_names().chain(angles).map(choice)).collect()
}

/// Takes a unit in place of the guess.
pub(super) fn choose_unit(fields: &mut [MappedField], key: &str, value: &str) -> Result<()> {
    let unit = UNITS.iter().find(|it| it.key == key);
    let of = unit.map_or(Unit::Radian, |it| it.of);
    let stated = Some(value).filter(|it| !it.is_empty()).map(|it| NamedUnit::parse(it, of));
    let stated = stated.transpose().map_err(choice_error)?;
    if unit.is_none() {
        return ErrorKind::Option.refuse(format!(
            "--column: found `{key}`, expected unit.angle, unit.length, unit.position or unit.orientation"
        ));
    }
    if let Some(field) = fields.iter_mut().find(|it| it.key == key) {
        field.chosen = stated.map_or("", NamedUnit::symbol).to_owned();
    }
    Ok(())
}

/// The error of a value that was chosen.
pub(super) fn choice_error(error: poecal_numerics::error::Error) -> poecal_numerics::error::Error {
    ErrorKind::Option.error(format!("--column: {}", error.message()))
}
