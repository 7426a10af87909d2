//! Columns by what their names say: joints in their order, three coordinates, the parts of an orientation.

use std::collections::BTreeMap;

use crate::table::conventions::CONVENTIONS;
use crate::table::header::Header;
use crate::table::mapping::ColumnMap;
use crate::table::numbered::{OTHERS, numbered, plain};
use crate::table::orientation::OrientationForm;
use poecal_arm::lie::angles::Angles;
use poecal_model::robot::Robot;
use poecal_numerics::named_unit::NamedUnit;

/// What names of columns of joints have in them.
const JOINT_WORDS: [&str; 5] = ["joint", "axis", "axe", "achse", "gelenk"];
/// What names of columns of what was measured have in them.
const MEASURED: [&str; 9] = ["meas", "actual", "tracker", "laser", "leica", "prism", "smr", "refl", "point"];
/// What names of columns have in them that say how good another one is.
const STATISTICS: [&str; 9] = ["std", "sigma", "stdev", "dev", "err", "rms", "cov", "noise", "u95"];
/// The coordinates of a position by the last words of their names.
const AXES: [[&str; 3]; 2] = [["x", "y", "z"], ["east", "north", "up"]];
/// What is written before x, y and z without anything between.
const BEFORE_AXIS: [&str; 8] = ["p", "t", "pos", "position", "tcp", "point", "meas", "target"];
/// Three angles that no maker calls so, and the form that they have most often.
const GREEK: (&[&str], Angles) = (&["alpha", "beta", "gamma"], Angles::XYZ);

/// Three angles by the last words of their names.
fn angles() -> impl Iterator<Item = (&'static [&'static str], Angles)> {
    // Our own names come first, as where they are read.
    let known = [false, true]
        .into_iter()
        .flat_map(|is_unique| CONVENTIONS.iter().filter(move |it| it.is_unique == is_unique));
    let known = known.filter_map(|it| {
        let OrientationForm::Angles(angles) = it.form else { return None };
        Some((it.columns, angles))
    });
    known.chain([GREEK])
}

/// What the names of some columns begin with, and the columns.
type Begun = (String, Vec<usize>);
/// The form of an orientation, and its columns.
type Oriented = (String, Vec<usize>);

/// The name of a column in words.
struct Words {
    stem: String,
    last: String,
    unit: Option<NamedUnit>,
}

impl Words {
    fn of(name: &str) -> Self {
        let mut words: Vec<String> = name
            .split(|it: char| !it.is_alphanumeric())
            .filter(|it| !it.is_empty())
            .map(str::to_lowercase)
            .collect();
        let unit = words.last().and_then(|it| NamedUnit::parse_any(it).ok()).filter(|_| words.len() > 1);
        if unit.is_some() {
            words.pop();
        }
        let last = words.pop().unwrap_or_default();
        let alone =
            last.strip_suffix(['x', 'y', 'z']).filter(|it| words.is_empty() && BEFORE_AXIS.contains(it));
        match alone {
            Some(stem) => {
                Words { stem: stem.to_owned(), last: last.chars().skip(stem.len()).collect(), unit }
            }
            None => Words { stem: words.join(" "), last, unit },
        }
    }

    /// How well a stem says that its columns were measured; none of statistics.
    fn rank(stem: &str) -> Option<usize> {
        let has = |words: &[&str]| words.iter().any(|word| stem.contains(word));
        match stem {
            _ if has(&STATISTICS) => None,
            "" => Some(3),
            _ if has(&MEASURED) => Some(2),
            _ if has(&OTHERS) => Some(0),
            _ => Some(1),
        }
    }
}

/// The columns of a header by their names.
pub(crate) struct Names<'h> {
    header: &'h Header<'h>,
    words: Vec<Words>,
    /// Whether the cells of each are numbers.
    numeric: Vec<bool>,
}

impl<'h> Names<'h> {
    pub(crate) fn new(header: &'h Header<'h>, numeric: Vec<bool>) -> Self {
        Names { header, words: header.cells.iter().map(|cell| Words::of(&cell.name)).collect(), numeric }
    }

    /// The unit that the name of a column ends with.
    pub(crate) fn unit(&self, column: usize) -> Option<NamedUnit> {
        self.words.get(column)?.unit
    }

    fn is_numeric(&self, column: usize) -> bool {
        self.numeric.get(column).copied().unwrap_or(false)
    }

    /// The column with exactly this name.
    pub(crate) fn named(&self, name: &str) -> Option<usize> {
        self.header.find(name).ok().flatten()
    }

    /// The columns of the joints: those of their names, those that are read without a mapping too, or as many as there are joints with a word for
    /// them, in their order.
    pub(crate) fn joints(&self, robot: &Robot, names: &[String]) -> Vec<Option<usize>> {
        let own: Vec<Option<usize>> = names.iter().map(|name| self.named(name)).collect();
        if own.iter().any(Option::is_some) {
            return own;
        }
        if let Some(found) = numbered(self.header, robot, &ColumnMap::default(), &robot.reading_names()) {
            return found.iter().map(|(_, column)| self.named(column)).collect();
        }
        let is_joint = |column: &usize| {
            let name = self.header.cells.get(*column).map(|cell| plain(&cell.name)).unwrap_or_default();
            let has = |words: &[&str]| words.iter().any(|word| name.contains(word));
            self.is_numeric(*column) && has(&JOINT_WORDS) && !has(&OTHERS) && !has(&STATISTICS)
        };
        let found: Vec<usize> = (0..self.words.len()).filter(is_joint).collect();
        if found.len() == names.len() { found.into_iter().map(Some).collect() } else { own }
    }

    /// The columns whose names end with these words and begin alike, with what they begin with; those that were measured, if there are several.
    fn ending(&self, last: &[&str], near: Option<&str>) -> Option<Begun> {
        let mut stems: BTreeMap<&str, Vec<Option<usize>>> = BTreeMap::new();
        for (column, words) in self.words.iter().enumerate().filter(|(column, _)| self.is_numeric(*column)) {
            let Some(part) = last.iter().position(|it| *it == words.last) else { continue };
            let found = stems.entry(&words.stem).or_insert_with(|| vec![None; last.len()]);
            if let Some(place) = found.get_mut(part) {
                place.get_or_insert(column);
            }
        }
        let whole = stems.into_iter().filter_map(|(stem, found)| {
            let found: Vec<usize> = found.into_iter().collect::<Option<_>>()?;
            let rank =
                Words::rank(stem).filter(|_| near.is_none_or(|near| stem.is_empty() || stem == near))?;
            Some((rank + usize::from(near == Some(stem)) * 4, stem, found))
        });
        let best = whole.reduce(|best, it| if it.0 > best.0 { it } else { best })?;
        Some((best.1.to_owned(), best.2))
    }

    /// The columns of the position, and what their names begin with.
    pub(crate) fn position(&self) -> Option<Begun> {
        AXES.iter().find_map(|axes| self.ending(axes, None))
    }

    /// The form of the orientation and its columns, beside a position whose columns begin with `near`.
    pub(crate) fn orientation(&self, near: Option<&str>) -> Option<Oriented> {
        let ends = |last: &[&str]| self.ending(last, near).map(|it| it.1);
        let of_four = |last: [&str; 4], form: &str| Some((form.to_owned(), ends(&last)?));
        let of_three = || angles().find_map(|(last, form)| Some((form.to_string(), ends(last)?)));
        of_four(["qx", "qy", "qz", "qw"], "quaternion_xyzw")
            .or_else(|| of_four(["q1", "q2", "q3", "q4"], "quaternion_wxyz"))
            .or_else(of_three)
    }

    /// The columns of a form that was chosen, as far as their names say so.
    pub(crate) fn parts(&self, form: OrientationForm, near: Option<&str>) -> Vec<Option<usize>> {
        let found = self.ending(form.part_names(), near).or_else(|| {
            let mut angles = angles().filter(|_| form.len() == 3);
            angles.find_map(|(last, _)| self.ending(last, near))
        });
        found.map_or_else(|| vec![None; form.len()], |it| it.1.into_iter().map(Some).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use crate::Separator;

    fn found(header: &str) -> (Option<Begun>, Option<Oriented>) {
        let header = Header::new(Path::new("x.csv"), 1, header, Separator::Comma).unwrap();
        let names = Names::new(&header, vec![true; header.cells.len()]);
        let position = names.position();
        let near = position.as_ref().map(|it| it.0.clone());
        let orientation = names.orientation(near.as_deref());
        (position, orientation)
    }

    #[test]
    fn what_was_measured_precedes_what_was_wanted_and_how_good_it_is() {
        let (position, orientation) = found(
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
            assert_eq!(found(header).0.map(|it| it.1), Some(columns), "{header}");
        }
        assert_eq!(found("x,y,sigma_x,sigma_y,sigma_z"), (None, None));
        assert_eq!(found("x,y,z,a,b,c").1, Some(("intrinsic_zyx".to_owned(), vec![3, 4, 5])));
    }
}
