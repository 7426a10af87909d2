//! Meaning of columns by their names: joints in their order, three coordinates, the parts of an orientation.

use std::collections::BTreeMap;

use crate::table::conventions::{CONVENTIONS, OrientationConvention};
use crate::table::header::Header;
use crate::table::mapping::ColumnMap;
use crate::table::numbered_columns::match_numbered_columns;
use crate::table::orientation::OrientationForm;
use crate::table::roles::{ColumnRole, plain_letters, without_unit};
use poecal_arm::lie::angles::Angles;
use poecal_model::robot::Robot;
use poecal_numerics::named_unit::NamedUnit;

/// The last words of the names of an orientation's columns, and its form.
type OrientationSuffixes = (&'static [&'static str], OrientationForm);

/// Three angles whose names no maker uses, and their most frequent form.
const GREEK: OrientationSuffixes = (&["alpha", "beta", "gamma"], OrientationForm::Angles(Angles::XYZ));

/// Orientations by the last words of their names: quaternions, then the angles of our form, in the order of the reader, then those of makers.
fn orientations() -> impl Iterator<Item = OrientationSuffixes> {
    let rank = |it: &&OrientationConvention| if it.form.len() == 4 { 0 } else { 1 + u8::from(it.is_unique()) };
    // Joints are named q0 to q3.
    let is_sought = |it: &&OrientationConvention| it.form.len() <= 4 && !it.has("q0");
    let mut known: Vec<&OrientationConvention> = CONVENTIONS.iter().filter(is_sought).collect();
    known.sort_by_key(rank);
    known.into_iter().map(|it| (it.columns, it.form)).chain([GREEK])
}

/// The common beginning of the names of some columns, and the columns.
type ColumnPrefixes = (String, Vec<usize>);

/// The name of a column in words.
struct ColumnWords {
    stem: String,
    last: String,
    unit: Option<NamedUnit>,
}

impl ColumnWords {
    fn from_name(name: &str) -> Self {
        let (name, unit) = without_unit(name);
        let words = name.split(|it: char| !it.is_alphanumeric()).filter(|it| !it.is_empty());
        let mut words: Vec<String> = words.map(str::to_lowercase).collect();
        let last = words.pop().unwrap_or_default();
        let is_before_axis = |stem: &&str| words.is_empty() && ColumnRole::Guessed.has(stem);
        match last.strip_suffix(['x', 'y', 'z']).filter(is_before_axis) {
            Some(stem) => ColumnWords { stem: stem.to_owned(), last: last.replacen(stem, "", 1), unit },
            None => ColumnWords { stem: words.join(" "), last, unit },
        }
    }

    /// Likelihood, by its stem, that a column was measured, as a rank; `None` for statistics.
    fn rank(stem: &str) -> Option<usize> {
        match stem {
            _ if ColumnRole::InStatistic.is_in(stem) => None,
            "" => Some(3),
            _ if ColumnRole::InMeasured.is_in(stem) => Some(2),
            _ if ColumnRole::Other.is_in(stem) => Some(0),
            _ => Some(1),
        }
    }
}

/// The columns of a header by their names.
pub(crate) struct HeaderNames<'h> {
    header: &'h Header<'h>,
    words: Vec<ColumnWords>,
    /// True for each column whose cells are numbers.
    numeric: Vec<bool>,
}

impl<'h> HeaderNames<'h> {
    pub(crate) fn new(header: &'h Header<'h>, numeric: Vec<bool>) -> Self {
        HeaderNames {
            header,
            words: header.cells.iter().map(|cell| ColumnWords::from_name(&cell.name)).collect(),
            numeric,
        }
    }

    /// The unit that the name of a column ends with.
    pub(crate) fn unit(&self, column: usize) -> Option<NamedUnit> {
        self.words.get(column)?.unit
    }

    /// The columns whose cells are numbers, with their names in words.
    fn numeric(&self) -> impl Iterator<Item = (usize, &ColumnWords)> {
        let words = self.words.iter().enumerate().zip(&self.numeric);
        words.filter(|(_, is_numeric)| **is_numeric).map(|(it, _)| it)
    }

    /// The column with exactly this name.
    pub(crate) fn find_exact(&self, name: &str) -> Option<usize> {
        self.header.find(name).ok().flatten()
    }

    /// The columns of the joints: by their names, by the names that are read without a mapping, or in their order, if as many columns as joints
    /// have a word for them.
    pub(crate) fn joints(&self, robot: &Robot, names: &[String]) -> Vec<Option<usize>> {
        let own: Vec<Option<usize>> = names.iter().map(|name| self.find_exact(name)).collect();
        if own.iter().any(Option::is_some) {
            return own;
        }
        if let Some(found) = match_numbered_columns(self.header, robot, &ColumnMap::default(), &robot.reading_names()) {
            return found.iter().map(|(_, column)| self.find_exact(column)).collect();
        }
        let is_joint = |column: &usize| {
            let name = self.header.cells.get(*column).map(|cell| plain_letters(&cell.name)).unwrap_or_default();
            ColumnRole::InJoint.is_in(&name) && !ColumnRole::Other.is_in(&name) && !ColumnRole::InStatistic.is_in(&name)
        };
        let found: Vec<usize> = self.numeric().map(|it| it.0).filter(is_joint).collect();
        if found.len() == names.len() { found.into_iter().map(Some).collect() } else { own }
    }

    /// The columns whose names end with these words and begin alike, with their common beginning; measured columns take precedence.
    fn find_by_suffix(&self, last: &[&str], near: Option<&str>) -> Option<ColumnPrefixes> {
        let mut stems: BTreeMap<&str, Vec<Option<usize>>> = BTreeMap::new();
        for (column, words) in self.numeric() {
            let Some(part) = last.iter().position(|it| it.eq_ignore_ascii_case(&words.last)) else {
                continue;
            };
            let found = stems.entry(&words.stem).or_insert_with(|| vec![None; last.len()]);
            if let Some(place) = found.get_mut(part) {
                place.get_or_insert(column);
            }
        }
        let whole = stems.into_iter().filter_map(|(stem, found)| {
            let found: Vec<usize> = found.into_iter().collect::<Option<_>>()?;
            let is_near = near.is_none_or(|near| stem.is_empty() || stem == near);
            let rank = ColumnWords::rank(stem).filter(|_| is_near)?;
            Some((rank + usize::from(near == Some(stem)) * 4, stem, found))
        });
        let (_, stem, found) = whole.reduce(|best, it| if it.0 > best.0 { it } else { best })?;
        Some((stem.to_owned(), found))
    }

    /// The columns of the position, and the beginning of their names.
    pub(crate) fn position(&self) -> Option<ColumnPrefixes> {
        ColumnRole::Axes.rows().find_map(|axes| self.find_by_suffix(&axes.split(' ').collect::<Vec<_>>(), None))
    }

    /// The form of the orientation and its columns, beside a position whose columns begin with `near`.
    pub(crate) fn orientation(&self, near: Option<&str>) -> Option<(OrientationForm, Vec<usize>)> {
        orientations().find_map(|(last, form)| Some((form, self.find_by_suffix(last, near)?.1)))
    }

    /// The columns of a form that was chosen, as far as their names show it.
    pub(crate) fn parts(&self, form: OrientationForm, near: Option<&str>) -> Vec<Option<usize>> {
        let angles = orientations().filter(|it| it.1.len() == 3 && form.len() == 3).map(|it| it.0);
        let found = std::iter::once(form.part_names()).chain(angles).find_map(|last| self.find_by_suffix(last, near));
        found.map_or_else(|| vec![None; form.len()], |it| it.1.into_iter().map(Some).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use crate::Separator;

    fn find_columns(header: &str) -> (Option<ColumnPrefixes>, Option<(String, Vec<usize>)>) {
        let header = Header::new(Path::new("x.csv"), 1, header, Separator::Comma).unwrap();
        let names = HeaderNames::new(&header, vec![true; header.cells.len()]);
        let position = names.position();
        let near = position.as_ref().map(|it| it.0.clone());
        let orientation = names.orientation(near.as_deref());
        (position, orientation.map(|(form, columns)| (form.mapping_text(), columns)))
    }

    #[test]
    fn what_was_measured_precedes_what_was_wanted_and_how_good_it_is() {
        let (position, orientation) = find_columns(
            "Goal x,Goal y,Goal z,meas_x,meas_std_x,meas_y,meas_std_y,meas_z,meas_std_z,meas_rx,meas_ry,meas_rz",
        );
        assert_eq!(position, Some(("meas".to_owned(), vec![3, 5, 7])));
        assert_eq!(orientation, Some(("rotation_vector".to_owned(), vec![9, 10, 11])));
    }

    #[test]
    fn units_and_words_of_many_kinds() {
        for (header, columns) in [
            ("x_mm,y_mm,z_mm", vec![0, 1, 2]),
            ("z,y,x", vec![2, 1, 0]),
            ("px,py,pz", vec![0, 1, 2]),
            ("no,East,North,Up", vec![1, 2, 3]),
        ] {
            assert_eq!(find_columns(header).0.map(|it| it.1), Some(columns), "{header}");
        }
        assert_eq!(find_columns("x,y,sigma_x,sigma_y,sigma_z"), (None, None));
        assert_eq!(find_columns("x,y,z,a,b,c").1, Some(("intrinsic_zyx".to_owned(), vec![3, 4, 5])));
    }
}
