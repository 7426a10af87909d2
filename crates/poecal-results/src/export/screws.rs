//! Screws of a product of exponentials, and the properties of joints that no other form can hold.

use serde::{Deserialize, Serialize};

use super::{ExportedText, Proof, unreadable_error};
use crate::calibration_file::{GravityEntry, PoseEntry};
use crate::model::{Model, ModelSource};
use nalgebra::Vector3;
use poecal_arm::lie::Screw;
use poecal_model::forms::AxisFrames;
use poecal_model::robot::{FactorReading, Joint, JointKind, Robot};
use poecal_numerics::error::Result;
use poecal_storage::json_text;

#[derive(Serialize, Deserialize)]
struct ScrewsFile {
    form: String,
    formula: String,
    units: String,
    robot: String,
    base: String,
    tip: String,
    joints: Vec<JointScrew>,
    home: PoseEntry,
}

#[derive(Serialize, Deserialize)]
struct JointScrew {
    name: String,
    kind: JointKind,
    v: [f64; 3],
    w: [f64; 3],
    limits: Option<[f64; 2]>,
}

pub(crate) fn write(robot: &Robot) -> Result<ExportedText> {
    // With offsets of readings included.
    let plain = AxisFrames::from_robot(robot)?.robot(robot)?;
    let file = ScrewsFile {
        form: "poe".to_owned(),
        formula: "T(q) = exp([S1] q1) ... exp([Sn] qn) home, with S = (v, w) in the base at zero and v = p x w of an axis through p"
            .to_owned(),
        units: "m, rad".to_owned(),
        robot: robot.name.clone(),
        base: robot.base_name.clone(),
        tip: robot.tip_name.clone(),
        joints: plain.joints.iter().map(of_joint).collect(),
        home: (&plain.home).into(),
    };
    let text = json_text(&file, "product of exponentials")?;
    let again = read(&text, &plain)?;
    Ok(ExportedText { text, notes: Vec::new(), proof: Proof::Again(again.into()) })
}

fn of_joint(joint: &Joint) -> JointScrew {
    JointScrew {
        name: joint.name.clone(),
        kind: joint.kind,
        v: joint.screw.v().into(),
        w: joint.screw.w().into(),
        limits: joint.limits.map(|limits| [limits.lower, limits.upper]),
    }
}

fn read(text: &str, of: &Robot) -> Result<Robot> {
    let file: ScrewsFile =
        serde_json::from_str(text).map_err(|error| unreadable_error(&format!("an error ({error})")))?;
    let mut robot = of.clone();
    for (joint, entry) in robot.joints.iter_mut().zip(&file.joints) {
        let (v, w) = (Vector3::from(entry.v), Vector3::from(entry.w));
        joint.screw = match entry.kind {
            JointKind::Revolute => Screw::revolute(&w, &w.cross(&v)),
            JointKind::Prismatic => Screw::prismatic(&v),
        };
    }
    robot.home = file.home.pose()?;
    Ok(robot)
}

/// Terms of joints beside a form that has geometry alone.
#[derive(Serialize)]
struct ExtraTerms<'a> {
    robot: &'a str,
    formula: &'static str,
    units: &'static str,
    /// Compliant joints, which turn by terms alone, with their axes.
    gives: Vec<JointScrew>,
    terms: Vec<ExtraTerm<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gravity: Option<&'a GravityEntry>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    factors: &'a [FactorReading],
}

#[derive(Serialize)]
struct ExtraTerm<'a> {
    joint: &'a str,
    term: String,
    formula: String,
    coefficient: f64,
}

/// Properties of the joints of a model that a form of geometry alone cannot hold.
pub(crate) fn describe_extra_terms(model: &Model) -> Result<Option<String>> {
    let plain = model.robot.without_offsets();
    if plain.terms.is_empty() {
        return Ok(None);
    }
    let terms = plain.terms.iter().filter_map(|it| {
        let joint = plain.joints.get(it.joint)?;
        Some(ExtraTerm {
            joint: &joint.name,
            term: it.term.to_string(),
            formula: it.term.formula(),
            coefficient: it.coefficient,
        })
    });
    let gravity = match &model.source {
        ModelSource::Calibration(file) => file.robot.gravity.as_ref(),
        ModelSource::Urdf(_) | ModelSource::Toml => None,
    };
    let file = ExtraTerms {
        robot: &plain.name,
        formula: "value of a joint = its reading + sum of coefficient * f, f as stated, of the values of all joints without terms; a compliant joint \
                  JOINT~x or JOINT~y (in `gives`) turns the link of JOINT about the screw (v, w), base frame, all joints at zero",
        units: "m, rad",
        gives: plain.joints.iter().filter(|joint| joint.give_of.is_some()).map(of_joint).collect(),
        terms: terms.collect(),
        gravity,
        factors: &plain.factors,
    };
    json_text(&file, "corrections of joints").map(Some)
}
