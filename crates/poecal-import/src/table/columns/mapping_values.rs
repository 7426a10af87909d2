//! Words of a mapping file as values: units, forms of an orientation, separators and signs.

use serde::Deserialize;
use serde::de::{Deserializer, Error as _};

use super::super::cells::Separator;
use super::super::number::DecimalSign;
use super::super::orientation::OrientationForm;
use poecal_model::robot::ThirdAxis;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// A string for `parse`; its error becomes the TOML error's message.
fn parsed<'de, D: Deserializer<'de>, T>(
    deserializer: D,
    parse: impl Fn(&str) -> Result<T>,
) -> std::result::Result<Option<T>, D::Error> {
    let text = String::deserialize(deserializer)?;
    parse(&text).map(Some).map_err(D::Error::custom)
}

pub(crate) fn length_unit<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<NamedUnit>, D::Error> {
    parsed(deserializer, |text| NamedUnit::parse(text, Unit::Metre))
}

pub(crate) fn angle_unit<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<NamedUnit>, D::Error> {
    parsed(deserializer, |text| NamedUnit::parse(text, Unit::Radian))
}

pub(crate) fn any_unit<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Option<NamedUnit>, D::Error> {
    parsed(deserializer, NamedUnit::parse_any)
}

pub(crate) fn orientation_form<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<OrientationForm, D::Error> {
    String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
}

pub(crate) fn third_axis<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<ThirdAxis>, D::Error> {
    parsed(deserializer, |text| match text {
        "arm" => Ok(ThirdAxis::Arm),
        "level" => Ok(ThirdAxis::Level),
        _ => ErrorKind::Syntax
            .refuse(format!("found the third axis `{text}`, expected `arm` or `level`, from which it counts")),
    })
}

pub(crate) fn separator<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<Separator>, D::Error> {
    parsed(deserializer, |text| match text {
        "," => Ok(Separator::Comma),
        ";" => Ok(Separator::Semicolon),
        "\t" | "tab" => Ok(Separator::Tab),
        " " | "whitespace" => Ok(Separator::Whitespace),
        _ => {
            ErrorKind::Syntax.refuse(format!("found the separator `{text}`, expected `,`, `;`, `tab` or `whitespace`"))
        }
    })
}

pub(crate) fn decimal_sign<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<DecimalSign>, D::Error> {
    parsed(deserializer, |text| match text {
        "." => Ok(DecimalSign::Point),
        "," => Ok(DecimalSign::Comma),
        _ => ErrorKind::Syntax.refuse(format!("found the decimal sign `{text}`, expected `.` or `,`")),
    })
}
