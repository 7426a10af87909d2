//! Meaning of a file's columns, from header, mapping and robot.

use super::builder::Builder;
use super::header::Header;
use super::inputs::RowInput;
use super::mapping::{ColumnMap, PoseDirection};
use super::targets::TargetLayout;
use crate::{FitWhere, ReadOptions};
use poecal_model::robot::{Controller, Robot};
use poecal_numerics::error::Result;

/// Source of a row's set; numbers are columns of the file.
#[derive(Clone, Debug, Default)]
pub(crate) enum SetRule {
    #[default]
    Unstated,
    Words(usize),
    Where(usize, FitWhere),
}

/// Columns of a row by meaning.
#[derive(Clone, Debug, Default)]
pub(crate) struct ColumnLayout {
    /// Readings in the robot's order, then measured numbers.
    pub(crate) inputs: Vec<RowInput>,
    pub(crate) targets: Vec<TargetLayout>,
    /// Column with the target's name.
    pub(crate) target_column: Option<usize>,
    /// Column with the name of the instrument or station.
    pub(crate) instrument: Option<usize>,
    /// Column with the name of a pair of configurations.
    pub(crate) pair: Option<usize>,
    pub(crate) id: Option<usize>,
    /// Column with the time of a row, and its unit in seconds.
    pub(crate) time: Option<(usize, f64)>,
    pub(crate) set: SetRule,
    pub(crate) pose: PoseDirection,
    /// Columns without meaning, each with a name of our form that may have been meant.
    pub(crate) ignored: Vec<(String, Option<String>)>,
    /// Joints with the numbered columns that were taken for them.
    pub(crate) numbered: Option<Vec<(String, String)>>,
    /// Conversion of columns into the joints' readings, if they do not match one to one.
    pub(crate) controller: Option<Controller>,
    /// Sums from the calibration, for a file that lacks some of their columns.
    missed: Option<String>,
}

impl ColumnLayout {
    /// The layout of a measurement file.
    pub(crate) fn new(header: &Header<'_>, robot: &Robot, options: &ReadOptions, map: &ColumnMap) -> Result<Self> {
        let mut builder = Builder::new(header, robot, map, options.controller.as_ref())?;
        let targets = builder.targets()?;
        builder.check_distinct()?;
        let target_column = match &map.target {
            Some(column) => Some(builder.text_column(column, "for the target's name")?),
            None if targets.len() == 1 && map.target_name.is_none() && map.targets.is_empty() => {
                builder.optional_text_column("target")?
            }
            None => None,
        };
        let instrument = match &map.instrument {
            Some(column) => Some(builder.text_column(column, "for the instrument's name")?),
            None => builder.optional_text_column("instrument")?,
        };
        let pair = builder.optional_text_column("pair")?;
        let id = builder.id_column()?;
        let set = set_rule(&mut builder, options, map)?;
        let time = builder.time_column();
        let (ignored, controller, pose) = (builder.ignored_columns(), builder.controller(robot), map.pose);
        let Builder { inputs, numbered, missed, .. } = builder;
        Ok(ColumnLayout {
            inputs,
            targets,
            target_column,
            instrument,
            pair,
            id,
            time,
            set,
            pose,
            ignored,
            numbered,
            controller,
            missed,
        })
    }

    /// Notes on the interpretation of the joints' columns for the user, a sentence each.
    pub(crate) fn joint_words(&self) -> Vec<String> {
        let missed = self.missed.as_ref().map(|sums| {
            format!(
                "the readings of the calibration were made of columns ({sums}), which are not all here: took these for the joint values of the \
                 model; a mapping (--columns) says otherwise"
            )
        });
        self.numbered_words().into_iter().chain(missed).collect()
    }

    /// The numbered columns that were taken for the joints, in words.
    fn numbered_words(&self) -> Option<String> {
        let (first, last) = (self.numbered.as_ref()?.first()?, self.numbered.as_ref()?.last()?);
        Some(format!(
            "no column has the name of a joint; took `{}` to `{}` for the joints from `{}` to `{}`, in the order of the chain",
            first.1, last.1, first.0, last.0
        ))
    }

    /// The layout of a file that has joint readings of pictures: joints, `id` and `set`.
    pub(crate) fn pictures(header: &Header<'_>, robot: &Robot, options: &ReadOptions, map: &ColumnMap) -> Result<Self> {
        let mut builder = Builder::new(header, robot, map, options.controller.as_ref())?;
        builder.check_distinct()?;
        let id = builder.id_column()?;
        let set = set_rule(&mut builder, options, map)?;
        builder.optional_text_column("image")?;
        Ok(ColumnLayout { set, ignored: builder.ignored_columns(), ..Self::of_joints(builder, id, robot) })
    }

    /// The layout of a file that is read only for its joints.
    pub(crate) fn joints(header: &Header<'_>, robot: &Robot, options: &ReadOptions, map: &ColumnMap) -> Result<Self> {
        let mut builder = Builder::new(header, robot, map, options.controller.as_ref())?;
        builder.check_distinct()?;
        let id = builder.id_column()?;
        let set = builder.optional_text_column("set")?.filter(|_| !options.ignore_sets);
        let layout = Self::of_joints(builder, id, robot);
        Ok(ColumnLayout { set: set.map_or(SetRule::Unstated, SetRule::Words), ..layout })
    }

    /// The layout of a file without any of these, with these columns without meaning.
    pub(crate) fn from_ignored(ignored: Vec<(String, Option<String>)>) -> Self {
        ColumnLayout { ignored, ..ColumnLayout::default() }
    }

    fn of_joints(mut builder: Builder<'_>, id: Option<usize>, robot: &Robot) -> Self {
        let time = builder.time_column();
        let controller = builder.controller(robot);
        let Builder { inputs, numbered, missed, .. } = builder;
        ColumnLayout { inputs, id, time, numbered, controller, missed, ..ColumnLayout::default() }
    }
}

/// The source of a row's set.
fn set_rule(builder: &mut Builder<'_>, options: &ReadOptions, map: &ColumnMap) -> Result<SetRule> {
    let rule = options.train_where.as_ref().or(map.set.as_ref()).cloned();
    let words = builder.optional_text_column("set")?.filter(|_| !options.ignore_sets);
    Ok(match (rule, words) {
        (Some(rule), _) if options.ignore_sets => {
            // A known column is not listed as ignored.
            builder.optional_text_column(&rule.column)?;
            SetRule::Unstated
        }
        (Some(rule), _) => {
            SetRule::Where(builder.text_column(&rule.column, "that states which rows are fitted")?, rule)
        }
        (None, Some(column)) => SetRule::Words(column),
        (None, None) => SetRule::Unstated,
    })
}
