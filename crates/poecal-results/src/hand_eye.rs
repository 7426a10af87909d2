//! `hand_eye.json`: pose of a camera with its bounds, and the texts of the files beside it.

use serde::Serialize;

use super::frame_entries::{FindingEntry, InputsEntry, VerdictEntry, name_of};
use super::frame_texts::NamedFrame;
use super::lens_entries::{LensEntry, lens_text};
use poecal_calibrate::ArmFitComparison;
use poecal_fit::hand_eye::{CameraMounting, Directions, FrameEstimate, HandEye};
use poecal_import as measurements;
use poecal_import::PosePairs;
use poecal_model::measurement::{Dataset, Noise};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::json_text;

/// Version word of `hand_eye.json`.
pub const SCHEMA: &str = "poecal-hand-eye-1";

/// Names of the frames in the output.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameNames {
    /// The arm's base.
    pub base: String,
    /// Its flange.
    pub flange: String,
    /// The camera, in OpenCV's axes.
    pub camera: String,
    /// The board or marker.
    pub target: String,
}

impl Default for FrameNames {
    fn default() -> Self {
        let [base, flange, camera, target] =
            ["base_link", "tool0", "camera_color_optical_frame", "target"].map(str::to_owned);
        FrameNames { base, flange, camera, target }
    }
}

impl std::str::FromStr for FrameNames {
    type Err = poecal_numerics::error::Error;

    /// Four names in this order, with commas between them.
    fn from_str(text: &str) -> Result<Self> {
        let is_plain =
            |name: &&str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "_-/.".contains(c));
        let names: Vec<&str> = text.split(',').map(str::trim).filter(is_plain).collect();
        let [base, flange, camera, target] = names[..] else {
            return ErrorKind::Option.refuse(format!(
                "found `{text}`, expected four names of letters, digits, `_`, `-`, `/` and `.`, like base_link,tool0,camera,board"
            ));
        };
        let [base, flange, camera, target] = [base, flange, camera, target].map(str::to_owned);
        Ok(FrameNames { base, flange, camera, target })
    }
}

impl FrameNames {
    /// Names with base and flange as in a robot.
    #[must_use]
    pub fn from_robot(robot: &Robot) -> Self {
        FrameNames { base: robot.base_name.clone(), flange: robot.tip_name.clone(), ..FrameNames::default() }
    }
}

/// A result with its input, for its files.
#[derive(Clone, Copy, Debug)]
pub struct HandEyeResult<'a> {
    /// The result.
    pub found: &'a HandEye,
    /// The poses.
    pub poses: &'a PosePairs,
    /// Names of frames.
    pub names: &'a FrameNames,
    /// The command that makes the same result; empty if there is none.
    pub command: &'a str,
    /// Additional results from joint readings.
    pub arm: Option<&'a ArmByJoints>,
}

/// Additional results of a hand-eye calibration from joint readings.
#[derive(Clone, Debug)]
pub struct ArmByJoints {
    /// The session as `calibrate` reads it.
    pub session: String,
    /// Errors of held-out poses with the arm held and with the arm fitted, or the reason why the arm was not fitted.
    pub errors: std::result::Result<ArmFitComparison, String>,
    /// The command that fits the arm with the camera.
    pub command: String,
}

impl ArmByJoints {
    /// Results from the session of a robot's joint readings, and the errors that were found with it.
    ///
    /// # Errors
    /// Those of an unknown unit.
    pub fn new(
        (robot, data): (&Robot, &Dataset),
        found: &HandEye,
        errors: Result<Option<ArmFitComparison>>,
        command: String,
    ) -> Result<Self> {
        let [across, along, tilt, turn] = found.noise;
        let noise = Noise::new(across.min(along), tilt.min(turn));
        let session = measurements::text(data, robot, &noise, "The poses of a hand-eye calibration that count")?;
        let errors = match errors {
            Ok(Some(errors)) => Ok(errors),
            Ok(None) => Err("no poses could be held out".to_owned()),
            Err(error) => Err(error.message().to_owned()),
        };
        Ok(ArmByJoints { session, errors, command })
    }
}

#[derive(Serialize)]
struct HandEyeFile<'a> {
    schema: &'static str,
    poecal_version: &'static str,
    inputs: InputsEntry<'a>,
    camera: &'static str,
    verdict: VerdictEntry<'a>,
    camera_frame: HandEyeFrameEntry,
    target_frame: HandEyeFrameEntry,
    directions: DirectionsEntry,
    poses: usize,
    fitted: usize,
    noise: HandEyeNoiseEntry,
    residual: ErrorEntry,
    #[serde(skip_serializing_if = "Option::is_none")]
    held_out: Option<ErrorEntry>,
    turns: TurnsEntry,
    outliers: Vec<HandEyeOutlierEntry<'a>>,
    findings: Vec<FindingEntry<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    arm: Option<ArmEntry<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lens: Option<LensEntry<'a>>,
}

/// A frame in all forms, with its bounds.
#[derive(Serialize)]
pub(crate) struct HandEyeFrameEntry {
    parent: String,
    child: String,
    position_m: [f64; 3],
    quaternion_xyzw: [f64; 4],
    matrix: [[f64; 4]; 4],
    rvec_rad: [f64; 3],
    rpy_rad: [f64; 3],
    bound95_mm: f64,
    bound95_deg: f64,
    sigma_mm: [f64; 3],
    sigma_deg: [f64; 3],
    static_transform_publisher: String,
    urdf_joint: String,
}

#[derive(Serialize)]
struct DirectionsEntry {
    flange: &'static str,
    target: &'static str,
    stated: bool,
}

impl DirectionsEntry {
    fn new(directions: &Directions) -> Self {
        DirectionsEntry {
            flange: if directions.flange_inverted { "flange_from_base" } else { "base_from_flange" },
            target: if directions.target_inverted { "target_from_camera" } else { "camera_from_target" },
            stated: directions.stated,
        }
    }
}

#[derive(Serialize)]
struct HandEyeNoiseEntry {
    across_mm: f64,
    along_mm: f64,
    tilt_deg: f64,
    turn_deg: f64,
    about_m: [f64; 3],
}

#[derive(Serialize)]
struct ErrorEntry {
    rows: usize,
    rms_mm: f64,
    rms_deg: f64,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ArmEntry<'a> {
    Compared { held: ErrorEntry, fitted: ErrorEntry, command: &'a str },
    NotFitted { not_fitted: &'a str, command: &'a str },
}

impl ArmEntry<'_> {
    fn new(arm: &ArmByJoints) -> ArmEntry<'_> {
        match &arm.errors {
            Ok(ArmFitComparison { rows, held, fitted }) => {
                let of = |errors: &(f64, f64)| ErrorEntry { rows: *rows, rms_mm: errors.0, rms_deg: errors.1 };
                ArmEntry::Compared { held: of(held), fitted: of(fitted), command: &arm.command }
            }
            Err(reason) => ArmEntry::NotFitted { not_fitted: reason, command: &arm.command },
        }
    }
}

#[derive(Serialize)]
struct TurnsEntry {
    sigma_deg: [f64; 3],
    directions: [[f64; 3]; 3],
}

#[derive(Serialize)]
struct HandEyeOutlierEntry<'a> {
    row: &'a str,
    shift_mm: f64,
    turn_deg: f64,
    flipped: bool,
}

impl HandEyeFrameEntry {
    pub(crate) fn new(frame: &NamedFrame, placed: &FrameEstimate) -> Self {
        HandEyeFrameEntry {
            parent: frame.parent.clone(),
            child: frame.child.clone(),
            position_m: frame.pose.translation.into(),
            quaternion_xyzw: frame.pose.quaternion_xyzw(),
            matrix: frame.matrix(),
            rvec_rad: frame.rvec(),
            rpy_rad: frame.rpy(),
            bound95_mm: 1e3 * placed.bound95_m,
            bound95_deg: placed.bound95_rad.to_degrees(),
            sigma_mm: (1e3 * placed.sigma_m).into(),
            sigma_deg: placed.sigma_rad.map(f64::to_degrees).into(),
            static_transform_publisher: frame.static_transform_publisher(),
            urdf_joint: frame.urdf_joint(),
        }
    }
}

impl HandEyeResult<'_> {
    /// The camera's frame and the target's, each with its bounds.
    #[must_use]
    pub fn frames(&self) -> [(NamedFrame, FrameEstimate); 2] {
        let FrameNames { base, flange, camera, target } = self.names;
        let HandEye { on_flange, in_base, .. } = self.found;
        let frame = |parent: &String, child: &String, placed: &FrameEstimate| {
            (NamedFrame { parent: parent.clone(), child: child.clone(), pose: placed.pose }, *placed)
        };
        match self.found.camera {
            CameraMounting::InHand => [frame(flange, camera, on_flange), frame(base, target, in_base)],
            CameraMounting::Beside => [frame(base, camera, in_base), frame(flange, target, on_flange)],
        }
    }

    fn name(&self, row: usize) -> &str {
        name_of(&self.poses.names, row)
    }

    /// The contents of `hand_eye.json`.
    ///
    /// # Errors
    /// [`ErrorKind::Export`] if it cannot be written as JSON.
    pub fn to_text(&self) -> Result<String> {
        let found = self.found;
        let [camera, target] = self.frames();
        let [across, along, tilt, turn] = found.noise;
        let fitted = found.rows.iter().filter(|it| it.is_fitted).count();
        let file = HandEyeFile {
            schema: SCHEMA,
            poecal_version: env!("CARGO_PKG_VERSION"),
            inputs: InputsEntry {
                command: self.command,
                sha256: &self.poses.sha256,
                understood: &self.poses.understood,
            },
            camera: found.camera.word(),
            verdict: VerdictEntry::new(found.level, &found.reasons),
            camera_frame: HandEyeFrameEntry::new(&camera.0, &camera.1),
            target_frame: HandEyeFrameEntry::new(&target.0, &target.1),
            directions: DirectionsEntry::new(&found.directions),
            poses: found.rows.len(),
            fitted,
            noise: HandEyeNoiseEntry {
                across_mm: 1e3 * across,
                along_mm: 1e3 * along,
                tilt_deg: tilt.to_degrees(),
                turn_deg: turn.to_degrees(),
                about_m: found.noise_about.into(),
            },
            residual: ErrorEntry {
                rows: fitted,
                rms_mm: 1e3 * found.residual.0,
                rms_deg: found.residual.1.to_degrees(),
            },
            held_out: found.held_out.map(|it| ErrorEntry {
                rows: it.rows,
                rms_mm: 1e3 * it.rms_m,
                rms_deg: it.rms_rad.to_degrees(),
            }),
            turns: TurnsEntry {
                sigma_deg: found.turns.spread_rad.map(f64::to_degrees),
                directions: found.turns.directions.map(Into::into),
            },
            outliers: found
                .outliers
                .iter()
                .map(|it| HandEyeOutlierEntry {
                    row: self.name(it.row),
                    shift_mm: 1e3 * it.shift_m,
                    turn_deg: it.turn_rad.to_degrees(),
                    flipped: it.is_flipped,
                })
                .collect(),
            findings: FindingEntry::all(&found.findings, &self.poses.names),
            arm: self.arm.map(ArmEntry::new),
            lens: found.lens.as_ref().map(LensEntry::new),
        };
        json_text(&file, "result")
    }

    /// The rows with their errors, as CSV.
    #[must_use]
    pub fn rows_text(&self) -> String {
        let mut text = "row,name,fitted,shift[mm],turn[deg]\n".to_owned();
        for (row, error) in self.found.rows.iter().enumerate() {
            let name = poecal_storage::csv_text::cell(self.name(row));
            let fitted = u8::from(error.is_fitted);
            text +=
                &format!("{},{name},{fitted},{:.6},{:.6}\n", row + 1, 1e3 * error.shift_m, error.turn_rad.to_degrees());
        }
        text
    }

    /// All files of a result beside `hand_eye.json`: names and texts.
    #[must_use]
    pub fn texts(&self) -> Vec<(&'static str, String)> {
        let [(camera, _), (target, _)] = self.frames();
        let FrameNames { base, flange, camera: camera_name, target: target_name } = self.names;
        let is_in_hand = self.found.camera == CameraMounting::InHand;
        let what = if is_in_hand { "EYE-IN-HAND" } else { "EYE-TO-HAND" };
        let mut texts = vec![
            ("transforms.txt", camera.short_forms() + "\n" + &target.short_forms()),
            ("easy_handeye2.calib", camera.easy_handeye2(is_in_hand, [base, flange, camera_name, target_name])),
            ("static_transform.launch.py", camera.launch_file(what)),
            ("opencv.yml", camera.opencv()),
            ("rows.csv", self.rows_text()),
        ];
        texts.extend(self.arm.map(|arm| ("session.csv", arm.session.clone())));
        texts.extend(self.found.lens.as_ref().map(|lens| ("lens.csv", lens_text(lens))));
        texts
    }
}
