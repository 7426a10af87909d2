//! Robot programs in the languages of their controllers: targets and the motions to them.
//!
//! This crate is a part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package. Its interface follows their needs
//! and promises nothing by itself.
//!
//! Each language has a folder. `scan.rs` has the tokens of all languages, `flow.rs` follows calls, branches and loops, [`parsed_program`] is the common
//! result, for files of joint readings (`poecal-import`) and for corrections (`poecal-compensate`).
//!
//! Other crates have files, corrections, and kinematics beyond a language's words for configurations.

#![forbid(unsafe_code)]

pub mod axes;
mod build;
mod fanuc;
mod flow;
pub mod forms;
mod krl;
mod language;
pub(crate) mod number;
pub mod parsed_program;
mod posture;
mod rapid;
pub(crate) mod scan;
mod shape;
pub mod stated_configuration;
mod stated_frames;
mod unchanged_statements;
mod urscript;

use axes::ControllerAxes;
use parsed_program::{ParsedProgram, PoseMeaning};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_storage::limits::ResourceLimit;

pub use language::Language;
pub use stated_frames::StatedFrames;
pub use unchanged_statements::UnchangedStatement;

/// The targets of a program and its motions.
///
/// # Errors
/// [`ErrorKind::Syntax`](poecal_numerics::error::ErrorKind::Syntax) if it is none, or has brackets or blocks nested more deeply than
/// [`ResourceLimit::Nesting`]; [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if it is larger than [`ResourceLimit::Program`].
pub fn parse(language: Language, text: &[u8], given: &StatedFrames, axes: &ControllerAxes) -> Result<ParsedProgram> {
    ResourceLimit::Program.refuse(text.len() as u64, format_args!("a program of {} bytes", text.len()))?;
    scan::refuse_nested(text, rules(language))?;
    match language {
        Language::UrScript => urscript::parse(text, given, axes),
        Language::Krl => krl::parse(text, given, axes),
        Language::Rapid => Ok(rapid::parse(text, given, axes)),
        Language::Fanuc => Ok(fanuc::parse(text, given, axes)),
    }
}

/// Syntax of a language.
fn rules(language: Language) -> &'static scan::LexicalRules {
    match language {
        Language::UrScript => &urscript::RULES,
        Language::Krl => &krl::RULES,
        Language::Rapid => &rapid::RULES,
        Language::Fanuc => &fanuc::RULES,
    }
}

/// Joint readings of a program, in the order of its motions, or of its text if it has none.
#[derive(Clone, Debug, Default)]
pub struct JointTargets {
    /// Line, name and readings (rad, m) of each.
    pub targets: Vec<(usize, String, Vec<f64>)>,
    /// Lines of targets that are poses.
    pub poses: Vec<usize>,
    /// Targets that are not known, with reasons.
    pub listed: Vec<UnchangedStatement>,
}

/// The joint targets of a program of a robot.
///
/// # Errors
/// Those of [`parse`].
pub fn joint_targets(language: Language, text: &[u8], robot: &Robot) -> Result<JointTargets> {
    let parsed = parse(language, text, &StatedFrames::default(), &ControllerAxes::from_robot(robot))?;
    let is_joints = |at: &usize| parsed.targets.get(*at).is_some_and(|it| it.meant == PoseMeaning::Joints);
    let moved: Vec<usize> = parsed.motions.iter().map(|it| it.target).filter(is_joints).collect();
    let all: Vec<usize> = (0..parsed.targets.len()).filter(is_joints).collect();
    let order = if moved.is_empty() { all } else { moved };
    let of = |at: usize| {
        let target = parsed.targets.get(at)?;
        Some((target.line, target.name.clone(), target.scaled_numbers()))
    };
    let poses = parsed.targets.iter().filter(|it| it.meant != PoseMeaning::Joints).map(|it| it.line).collect();
    Ok(JointTargets { targets: order.into_iter().filter_map(of).collect(), poses, listed: parsed.listed })
}
