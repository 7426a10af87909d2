//! Names of columns and their units.

use super::cells::Cell;
use super::roles::unit_of;
use poecal_numerics::named_unit::NamedUnit;

/// A column of the header: `name[unit]` or `name (unit)`.
#[derive(Clone, Debug)]
pub(crate) struct HeaderCell {
    /// Text in the file.
    pub(crate) text: String,
    /// Name without the unit.
    pub(crate) name: String,
    /// Unit in brackets.
    pub(crate) unit: Option<String>,
    /// Unit in the line of units, with its column there.
    pub(super) below: Option<(usize, String)>,
    pub(super) column: usize,
}

impl HeaderCell {
    fn new(text: &str, column: usize) -> Self {
        // Round brackets may be part of a name.
        let is_unit = |unit: &str| NamedUnit::parse_any(unit.trim()).is_ok();
        // A number in brackets is an index, as in `q[0]`.
        let is_index = |unit: &str| !unit.is_empty() && unit.bytes().all(|it| it.is_ascii_digit());
        let (name, unit) = split_brackets(text, '[', ']')
            .filter(|(_, unit)| !is_index(unit.trim()))
            .or_else(|| split_brackets(text, '(', ')').filter(|(_, unit)| is_unit(unit)))
            .or_else(|| split_brackets(text, '（', '）').filter(|(_, unit)| is_unit(unit)))
            // Theses write `q_1 / deg`.
            .or_else(|| text.rsplit_once('/').filter(|(name, unit)| !name.trim().is_empty() && is_unit(unit)))
            .map_or((text, None), |(name, unit)| (name.trim_end(), Some(unit.trim().to_owned())));
        HeaderCell {
            text: text.to_owned(),
            name: name.to_owned(),
            unit: unit.filter(|unit| !unit.is_empty()),
            below: None,
            column,
        }
    }

    /// Its units, in brackets and in the line of units.
    pub(crate) fn units(&self) -> impl Iterator<Item = &str> {
        self.unit.as_deref().into_iter().chain(self.below.iter().map(|(_, unit)| strip_brackets(unit)))
    }
}

/// A text that ends with brackets: the parts before and in them.
pub(crate) fn split_brackets(text: &str, open: char, close: char) -> Option<(&str, &str)> {
    text.strip_suffix(close)?.rsplit_once(open)
}

/// The unit in a column's name, as `x_mm` or `x in mm`.
pub(crate) fn unit_in_name(text: &str, name: &str) -> Option<NamedUnit> {
    let start = text.get(..name.len()).filter(|start| start.eq_ignore_ascii_case(name))?;
    let rest = text.get(start.len()..).filter(|rest| !rest.starts_with(char::is_alphanumeric))?;
    let words = rest.split(|c: char| !c.is_alphanumeric() && c != '°').filter(|word| !word.is_empty());
    match words.collect::<Vec<_>>().as_slice() {
        [unit] | ["in", unit] => unit_of(unit),
        _ => None,
    }
}

/// True if the cells below a header are units: one is, and none is a number. (Each is checked when it is needed.)
pub(crate) fn are_units(cells: &[Cell<'_>]) -> bool {
    cells.iter().any(|cell| NamedUnit::parse_any(strip_brackets(cell.raw)).is_ok())
        && !cells.iter().any(|cell| is_number(cell.raw))
}

/// A unit without brackets.
pub(super) fn strip_brackets(text: &str) -> &str {
    let inside = |open, close| text.strip_prefix(open)?.strip_suffix(close);
    inside('[', ']').or_else(|| inside('(', ')')).unwrap_or(text).trim()
}

/// The name of the column of a joint's position, beside one of its name: `field.position0` for `field.name0`, `position[0]` for `name[0]`.
pub(super) fn beside_name(text: &str) -> Option<String> {
    let end = text.strip_suffix(']').unwrap_or(text);
    let digits = end.len() - end.trim_end_matches(|it: char| it.is_ascii_digit()).len();
    let (start, number) = (text.get(..end.len() - digits)?, text.get(end.len() - digits..)?);
    let stem =
        start.strip_suffix("name").map(|stem| (stem, "")).or(start.strip_suffix("name[").map(|stem| (stem, "[")));
    let (stem, bracket) = stem.filter(|_| digits > 0)?;
    Some(format!("{stem}position{bracket}{number}"))
}

pub(crate) fn is_number(text: &str) -> bool {
    text.replace(',', ".").parse::<f64>().is_ok()
}

pub(crate) fn header_cells(text: &str, cells: &[Cell<'_>]) -> Vec<HeaderCell> {
    // Counts from cell to cell, since there may be very many.
    let (mut column, mut offset) = (1, 0);
    let cell = |cell: &Cell<'_>| {
        column += text.get(offset..cell.offset).map_or(0, |passed| passed.chars().count());
        offset = offset.max(cell.offset);
        HeaderCell::new(&cell.text(), column)
    };
    cells.iter().map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_brackets_are_units_only_where_they_hold_one() {
        let parts = |text: &str| {
            let cell = HeaderCell::new(text, 1);
            (cell.name, cell.unit)
        };
        let is = |name: &str, unit: &str| (name.to_owned(), Some(unit.to_owned()));
        assert_eq!(parts("x (mm)"), is("x", "mm"));
        assert_eq!(parts("joint1(Degrees)"), is("joint1", "Degrees"));
        assert_eq!(parts("x [parsec]"), is("x", "parsec"));
        for name in ["joint(1)", "A (left)", "x (MM)", "x (-)", "x ()"] {
            assert_eq!(parts(name), (name.to_owned(), None));
        }
    }

    #[test]
    fn units_are_seen_in_names() {
        let symbol = |text: &str, name: &str| unit_in_name(text, name).map(NamedUnit::symbol);
        for text in ["x_mm", "x-mm", "X.mm", "x in mm", "x / MM", "x (MM)", "x_[mm]"] {
            assert_eq!(symbol(text, "x"), Some("mm"), "{text}");
        }
        assert_eq!(symbol("joint1_degrees", "joint1"), Some("deg"));
        for text in ["xmm", "x_left", "x_left_mm", "x", "ax_mm", "x1_mm"] {
            assert_eq!(symbol(text, "x"), None, "{text}");
        }
    }
}
