//! Axes as controllers number them, and the joints of the model that they are: an arm's own axes, and external ones such as a rail.

use std::collections::{BTreeMap, BTreeSet};

use super::OpeningContext;
use super::made_table::{CellValue, FileLine, MadeTable, Refusal, TableColumn};
use super::words::{number, quote_names};
use crate::table::mapping::ColumnMap;

/// The value of an axis, and its unit if that is stated.
#[derive(Clone, Copy)]
pub(super) struct AxisValue<'t> {
    pub(super) value: &'t str,
    pub(super) unit: Option<&'t str>,
}

/// A configuration: its line, its name, and its axes by their numbers, which are small since tables have as many columns.
pub(super) struct ListedConfiguration<'t> {
    pub(super) line: usize,
    pub(super) name: String,
    pub(super) own: BTreeMap<u8, AxisValue<'t>>,
    pub(super) external: BTreeMap<u8, AxisValue<'t>>,
}

/// Names of axes before their number, and of configurations.
pub(super) struct AxisWords {
    pub(super) own: &'static str,
    pub(super) external: &'static str,
    pub(super) all: &'static str,
}

/// An axis by its number.
#[derive(Clone, Copy, PartialEq, Eq)]
enum AxisSlot {
    Own(u8),
    External(u8),
}

impl<'t> ListedConfiguration<'t> {
    /// A configuration without axes.
    pub(super) fn new(line: usize, name: String) -> Self {
        ListedConfiguration { line, name, own: BTreeMap::new(), external: BTreeMap::new() }
    }

    fn axis(&self, place: AxisSlot) -> Option<AxisValue<'t>> {
        match place {
            AxisSlot::Own(at) => self.own.get(&at),
            AxisSlot::External(at) => self.external.get(&at),
        }
        .copied()
    }
}

impl AxisValue<'_> {
    fn is_zero(&self) -> bool {
        number(self.value) == Some(0.0)
    }

    /// True if its unit, if one is stated, is that of a joint.
    fn fits(&self, slides: bool) -> bool {
        self.unit.is_none_or(|it| (it == "mm") == slides)
    }
}

/// All axes of a file, and the joints of the model.
struct FileAxes<'a, 't> {
    listed: &'a [ListedConfiguration<'t>],
    words: &'a AxisWords,
    own: u8,
    external: Vec<u8>,
    slides: Vec<bool>,
}

impl<'a, 't> FileAxes<'a, 't> {
    fn new(listed: &'a [ListedConfiguration<'t>], words: &'a AxisWords, slides: Vec<bool>) -> Self {
        let last = listed.iter().filter_map(|it| it.own.keys().max()).max();
        let external: BTreeSet<u8> = listed.iter().flat_map(|it| it.external.keys().copied()).collect();
        let mut own = last.copied().unwrap_or_default();
        // Telegrams have six axes of arms with four.
        let is_unused = |own: u8| listed.iter().all(|it| it.own.get(&own).is_none_or(AxisValue::is_zero));
        while usize::from(own) > slides.len() && is_unused(own) {
            own -= 1;
        }
        FileAxes { listed, words, own, external: external.into_iter().collect(), slides }
    }

    fn name(&self, place: AxisSlot) -> String {
        match place {
            AxisSlot::Own(at) => format!("{}{at}", self.words.own),
            AxisSlot::External(at) => format!("{}{at}", self.words.external),
        }
    }

    /// The unit of an axis at its first occurrence.
    fn unit(&self, place: AxisSlot) -> Option<&'t str> {
        self.listed.iter().find_map(|it| it.axis(place)).and_then(|it| it.unit)
    }

    /// The axis of each joint. Own axes are the joints that turn, or all joints if their units agree; external axes are the others.
    fn of_joints(&self) -> Option<Vec<AxisSlot>> {
        let turning = self.slides.iter().filter(|it| !**it).count();
        // A slide at an end of the chain may be a rail, which has no number of the arm's.
        let ends = self.slides.first() == Some(&true) || self.slides.last() == Some(&true);
        let is_stated = (1..=self.own).all(|at| self.unit(AxisSlot::Own(at)).is_some());
        let is_all = usize::from(self.own) == self.slides.len() && (is_stated || !ends);
        if !is_all && usize::from(self.own) != turning {
            return None;
        }
        let mut own = (1..=self.own).map(AxisSlot::Own);
        let mut external = self.external.iter().copied().map(AxisSlot::External);
        let places = self.slides.iter().map(|slides| if is_all || !slides { own.next() } else { external.next() });
        let places: Vec<AxisSlot> = places.collect::<Option<_>>()?;
        let fits = |row: &ListedConfiguration<'_>| {
            let mut all = places.iter().zip(&self.slides);
            all.all(|(place, slides)| row.axis(*place).is_none_or(|it| it.fits(*slides)))
                && row.external.iter().all(|(at, it)| places.contains(&AxisSlot::External(*at)) || it.is_zero())
        };
        self.listed.iter().all(fits).then_some(places)
    }

    /// All axes of the file.
    fn all(&self) -> Vec<AxisSlot> {
        let external = self.external.iter().copied().map(AxisSlot::External);
        (1..=self.own).map(AxisSlot::Own).chain(external).collect()
    }

    /// The error of axes that do not match the joints one to one.
    fn refuse<T>(&self, joints: &[String]) -> Result<T, Refusal> {
        let axes = self.all().into_iter().map(|it| match self.unit(it) {
            Some(unit) => format!("{} ({unit})", self.name(it)),
            None => self.name(it),
        });
        let axes: Vec<String> = axes.collect();
        let joint = |(name, slides): (&String, &bool)| format!("`{name}`{}", if *slides { " (slides)" } else { "" });
        let joints: Vec<String> = joints.iter().zip(&self.slides).map(joint).collect();
        FileLine(self.listed.first().map_or(1, |it| it.line)).refuse(format!(
            "found the axes {}, which are not one to one the joints {}, expected an axis of the arm for each joint that turns, an external one for each that \
             slides, and 0 of others: name the column of each joint by --columns",
            axes.join(", "),
            joints.join(", ")
        ))
    }
}

/// The table of configurations in degrees and millimetres, with their names in the first column. If a mapping is to match the axes to the joints,
/// the axes keep their names in the file.
pub(super) fn make_table(
    listed: &[ListedConfiguration<'_>],
    first: TableColumn,
    words: &AxisWords,
    opening: &OpeningContext<'_>,
) -> Result<MadeTable, Refusal> {
    let joints = opening.robot.joint_reading_names();
    if listed.is_empty() {
        return Refusal::refuse_whole(
            "found no joint readings, expected at least one configuration as angles of the joints",
        );
    }
    let axes = FileAxes::new(listed, words, opening.slides());
    let is_mapped = opening.options.mapping.as_ref().is_some_and(ColumnMap::names_columns);
    let (places, columns): (Vec<AxisSlot>, Vec<TableColumn>) = match axes.of_joints() {
        Some(places) => (places, opening.joint_columns("deg").collect()),
        None if is_mapped => {
            let column = |it: AxisSlot| {
                let unit = axes.unit(it).or(matches!(it, AxisSlot::Own(_)).then_some("deg"));
                let own = TableColumn::from(axes.name(it));
                (it, unit.map_or(own.clone(), |unit| own.in_unit(unit)))
            };
            axes.all().into_iter().map(column).unzip()
        }
        None => return axes.refuse(&joints),
    };
    let mut made = MadeTable::new(listed.first().map_or(1, |it| it.line), std::iter::once(first).chain(columns));
    for row in listed {
        let values = places.iter().map(|place| row.axis(*place).ok_or(*place));
        let values: Result<Vec<AxisValue<'_>>, AxisSlot> = values.collect();
        match values {
            Ok(values) => made.row(
                row.line,
                std::iter::once(CellValue::Text(&row.name)).chain(values.iter().map(|it| CellValue::Text(it.value))),
            ),
            Err(missing) => {
                return FileLine(row.line).refuse(format!(
                    "found no axis {} of `{}`, expected it as in the others: the file may be cut off",
                    axes.name(missing),
                    row.name
                ));
            }
        }
    }
    made.say(format!("{} {} in deg", made.rows(), words.all));
    let external = |it: &(&AxisSlot, &String)| matches!(it.0, AxisSlot::External(_));
    if axes.slides.len() == places.len() {
        let taken: Vec<_> = places.iter().zip(&joints).filter(external).collect();
        for (place, joint) in taken {
            made.say(format!("{} is {} in mm", axes.name(*place), quote_names([joint])));
        }
    }
    Ok(made)
}
