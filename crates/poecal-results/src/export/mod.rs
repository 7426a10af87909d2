//! Exports: a calibrated robot in the forms of controllers, drivers, simulators and other tools, each read back and compared.
//!
//! One module for each form, from axis frames or DH tables (`poecal-model`'s `forms`), with a variant of [`ExportFormat`]. The text is read back on
//! 1,000 configurations. `onto_urdf.rs` puts the numbers in a URDF that is named instead (`--onto`, `poecal export --onto`).

mod export_check;
mod mjcf;
mod motors;
mod names;
mod numbers;
mod offsets;
mod onto_urdf;
mod origins;
mod pal;
mod screws;
mod sdf;
mod tables;
mod transforms;
mod usd;

use std::borrow::Cow;

pub use export_check::ExportedRobot;
pub use onto_urdf::write_onto;

use super::model::{Model, ModelFormat, convert};
use export_check::{
    CONFIGURATIONS, ExportedText, Proof, SAME, export_error, is_same, left_out, read_back, remaining_difference,
    unreadable_error,
};
use origins::Flavour;
use poecal_formats::proof::Difference;
use poecal_formats::urdf::ConvertedModel;
use poecal_model::forms::DhConvention;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// Defines the forms by their words.
macro_rules! formats {
    ($($(#[$doc:meta])* $name:ident = $word:literal,)+) => {
        /// A form.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum ExportFormat {
            $($(#[$doc])* $name,)+
        }

        impl ExportFormat {
            /// All forms.
            pub const ALL: [ExportFormat; 19] = [$(ExportFormat::$name),+];

            /// Its word, as the program and the package name it.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self {
                    $(ExportFormat::$name => $word,)+
                }
            }
        }
    };
}

formats! {
    /// URDF: the text that was calibrated, or a new one.
    Urdf = "urdf",
    /// A TOML model of poecal, of screws.
    Toml = "toml",
    /// Screws of a product of exponentials, JSON.
    Poe = "poe",
    /// Denavit and Hartenberg's table, JSON.
    Dh = "dh",
    /// Craig's table, JSON.
    Mdh = "mdh",
    /// Denavit and Hartenberg's table with Hayati's rows, JSON.
    Hayati = "hayati",
    /// Origins of a URDF's joints by their names, YAML: for xacro's `load_yaml`.
    Origins = "origins",
    /// The kinematics file of Universal Robots' driver, YAML.
    Ur = "ur",
    /// The kinematics file of uFactory's description, YAML.
    Xarm = "xarm",
    /// The kinematics file of Franka's description, YAML.
    Franka = "franka",
    /// PAL Robotics' master calibration, YAML: differences of the origins of a URDF.
    Pal = "pal",
    /// LeRobot's calibration of motors, JSON: joint offsets in ticks.
    Lerobot = "lerobot",
    /// MuJoCo's model, XML.
    Mjcf = "mjcf",
    /// Gazebo's model, XML.
    Sdf = "sdf",
    /// USD physics, text.
    Usd = "usd",
    /// Origins, a row for each joint.
    Csv = "csv",
    /// The best joint offsets, base and tool, JSON.
    Offsets = "offsets",
    /// Located frames as transforms: ROS 2, URDF, quaternions and so on.
    Tf = "tf",
    /// Arrays of C with the nominal and the actual arm, for kinematics on a controller.
    C = "c",
}

/// Inputs that some forms need beside the robot.
#[derive(Clone, Debug, Default)]
pub struct ExportOptions {
    /// The controller's checksum, which Universal Robots' driver compares.
    pub hash: Option<String>,
    /// LeRobot's existing calibration of motors, whose offsets are corrected.
    pub motors: Option<String>,
}

/// Writes a robot in a form, reads it back and compares the tip on 1,000 configurations.
///
/// # Errors
/// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if the form cannot hold the robot, or the text read back
/// differs by more than 1e-9 m (of a robot of a metre) or rad though the form can carry it.
pub fn export(model: &Model, format: ExportFormat, options: &ExportOptions) -> Result<ExportedRobot> {
    let counted = model.sums().map(|it| {
        format!(
            "readings of this form are the model's, which the mapping made of what the controller counts: {}",
            it.words()
        )
    });
    let mut notes: Vec<String> = counted.clone().into_iter().collect();
    let plain = geometry(&model.robot, format, &mut notes);
    let robot = plain.as_ref();
    let written = match format {
        ExportFormat::Tf => return transforms::write(model),
        ExportFormat::C => {
            let mut exported = numbers::write(model).map_err(|error| error.in_file(&model.path))?;
            exported.notes.splice(0..0, counted);
            return Ok(exported);
        }
        ExportFormat::Urdf => return convert_model(model, robot, ModelFormat::Urdf, notes),
        ExportFormat::Toml => return convert_model(model, robot, ModelFormat::Toml, notes),
        ExportFormat::Poe => screws::write(robot),
        ExportFormat::Dh => tables::write(robot, DhConvention::Standard),
        ExportFormat::Mdh => tables::write(robot, DhConvention::Modified),
        ExportFormat::Hayati => tables::write(robot, DhConvention::Hayati),
        ExportFormat::Origins => origins::write(model, robot, &Flavour::Names),
        ExportFormat::Ur => origins::write(model, robot, &Flavour::Ur(options.hash.as_deref())),
        ExportFormat::Xarm => origins::write(model, robot, &Flavour::Xarm),
        ExportFormat::Franka => origins::write(model, robot, &Flavour::Franka),
        ExportFormat::Csv => origins::write_csv(robot),
        ExportFormat::Pal => pal::write(model, robot),
        ExportFormat::Lerobot => motors::write_motors(model, robot, options.motors.as_deref()),
        ExportFormat::Offsets => offsets::write(model, robot),
        ExportFormat::Mjcf => mjcf::write(robot),
        ExportFormat::Sdf => sdf::write(robot),
        ExportFormat::Usd => usd::write(robot),
    }
    .map_err(|error| error.in_file(&model.path))?;
    let (remains, must_be_same) = match &written.proof {
        Proof::Again(again) => (remaining_difference(robot, again), true),
        Proof::Remains(remains) => (*remains, false),
    };
    if must_be_same && !is_same(robot, &remains) {
        let message = format!(
            "the text read back differs by {:.1e} m and {:.1e} rad, expected at most {SAME:e}: nothing was written",
            remains.position_m, remains.rotation_rad
        );
        return Err(export_error(message).in_file(&model.path));
    }
    notes.extend(written.notes);
    notes.extend(left_out(robot));
    Ok(ExportedRobot { text: written.text, notes, remains, beside: screws::describe_extra_terms(model)? })
}

/// The robot that a form of geometry can hold: without compliant joints and terms of joint values, with offsets in the screws. A note states the
/// resulting loss. TOML can hold terms that need no weights.
fn geometry<'a>(robot: &'a Robot, format: ExportFormat, notes: &mut Vec<String>) -> Cow<'a, Robot> {
    let gives = robot.joints.iter().any(|joint| joint.give_of.is_some());
    let is_held = format == ExportFormat::Toml && robot.terms.iter().all(|it| !it.term.needs_gravity());
    if !gives && (robot.terms.is_empty() || is_held) {
        return Cow::Borrowed(robot);
    }
    let mut plain = robot.without_offsets().rigid();
    plain.terms.clear();
    let lost = remaining_difference(robot, &plain).position_m * 1e3;
    if gives || !robot.without_offsets().terms.is_empty() {
        notes.push(format!(
            "this form has geometry alone: without what the joints do beyond it, the tip is off by up to {lost:.3} mm"
        ));
    }
    Cow::Owned(plain)
}

/// A model's own forms.
fn convert_model(model: &Model, robot: &Robot, to: ModelFormat, mut said: Vec<String>) -> Result<ExportedRobot> {
    let plain = Model { robot: robot.clone(), ..model.clone() };
    let ConvertedModel { text, notes } = convert(&plain, to)?;
    said.extend(notes);
    let notes = said;
    let beside = if robot == &model.robot { None } else { screws::describe_extra_terms(model)? };
    // `convert` has compared them.
    Ok(ExportedRobot { text, notes, remains: Difference { position_m: 0.0, rotation_rad: 0.0 }, beside })
}
