//! Check of options that concern forms of files.

use super::missing_forms::{BODIES, unused_option_error};
use crate::Join;
use crate::instruments::{BAG, RECORDINGS, WORKBOOK};
use crate::read::MeasurementReader;
use poecal_numerics::error::Result;

impl MeasurementReader<'_> {
    /// Refuses options for forms of files that are absent.
    pub(crate) fn refuse_unused(&self) -> Result<()> {
        let forms = || self.found.understood.iter().filter_map(|it| it.form);
        let is_of = |options: &[&str]| forms().any(|it| options.contains(&it));
        let options = self.options;
        let all = [
            (options.sheet.is_some(), is_of(&[WORKBOOK]), "--sheet", "a workbook"),
            (options.body.is_some(), is_of(&RECORDINGS) || is_of(&[BAG]), "--body", BODIES),
            (!options.topics.is_empty(), is_of(&[BAG]), "--topic", "a ROS 2 bag"),
            (
                options.lag.is_some(),
                matches!(self.found.join, Some(Join::Time | Join::Motion)),
                "--lag",
                "two recordings that are joined by their times",
            ),
        ];
        match all.into_iter().find(|(is_stated, is_used, ..)| *is_stated && !is_used) {
            Some((.., option, what)) => Err(unused_option_error(option, what)),
            None => Ok(()),
        }
    }
}
