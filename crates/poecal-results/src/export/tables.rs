//! Tables of Denavit and Hartenberg, Craig, and Hayati, JSON.

use serde::{Deserialize, Serialize};

use super::{ExportedText, Proof, unreadable_error};
use crate::calibration_file::PoseEntry;
use poecal_model::forms::{DhConvention, DhEntry, DhTable};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_storage::json_text;

#[derive(Serialize, Deserialize)]
struct TablesFile {
    form: String,
    convention: DhConvention,
    formula: String,
    units: String,
    robot: String,
    base: String,
    tip: String,
    base_from_first: PoseEntry,
    rows: Vec<DhEntry>,
    last_from_tip: PoseEntry,
}

pub(crate) fn write(robot: &Robot, convention: DhConvention) -> Result<ExportedText> {
    let table = DhTable::from_robot(robot, convention)?;
    let file = TablesFile {
        form: "dh".to_owned(),
        convention,
        formula: format!(
            "T(q) = base_from_first * rows * last_from_tip; row: {}, with q added to theta of a revolute and to d of a prismatic joint",
            convention.formula()
        ),
        units: "m, rad".to_owned(),
        robot: robot.name.clone(),
        base: robot.base_name.clone(),
        tip: robot.tip_name.clone(),
        base_from_first: (&table.base_from_first).into(),
        rows: table.rows,
        last_from_tip: (&table.last_from_tip).into(),
    };
    let text = json_text(&file, "table")?;
    let again: TablesFile =
        serde_json::from_str(&text).map_err(|error| unreadable_error(&format!("an error ({error})")))?;
    let again = DhTable {
        convention: again.convention,
        base_from_first: again.base_from_first.pose()?,
        rows: again.rows,
        last_from_tip: again.last_from_tip.pose()?,
    };
    Ok(ExportedText { text, notes: Vec::new(), proof: Proof::Again(again.frames().robot(robot)?.into()) })
}
