//! Robot models of any form: choice of the reader, and conversion.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::calibration_file::CalibrationFile;
use poecal_arm::lie::Pose;
use poecal_formats::foreign::ForeignForm;
use poecal_formats::proof::Difference;
use poecal_formats::robot_toml;
use poecal_formats::urdf::{self, ChainSelection, ConvertedModel, UrdfDocument};
use poecal_import::ReadOptions;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Controller, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result, first_few};
use poecal_plan::plan::RobotError;
use poecal_storage::{looks_like, source_text};

/// Description of a model's file.
const MODEL: &str = "a robot model (URDF, MJCF, SDF, TOML or calibration.json)";

/// Source of a model.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_results::model::{Model, ModelSource};
/// #     pub use poecal_model::simulate;
/// # }
/// use poecal::{Model, ModelSource};
/// use poecal::simulate::elbow;
/// let model = Model { robot: elbow(), source: ModelSource::Toml, path: "elbow.toml".into() };
/// assert_eq!(model.robot.joints.len(), 6);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum ModelSource {
    /// A URDF text, into which other values can be written; for a model of another form (MJCF, SDF, a driver's YAML, a controller's conf) the
    /// equivalent URDF.
    Urdf(Box<UrdfDocument>),
    /// A TOML model.
    Toml,
    /// A `calibration.json`; the model is the calibrated robot.
    Calibration(Box<CalibrationFile>),
}

/// A robot and its source.
///
/// ```no_run
/// use poecal_results::model::{Model, ModelFormat, convert};
/// let model = Model::read("robot.urdf", &Default::default())?;
/// let converted = convert(&model, ModelFormat::Toml)?;
/// assert!(converted.text.starts_with("poecal_robot = 1"));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The robot.
    pub robot: Robot,
    /// Its source.
    pub source: ModelSource,
    /// File name as stated by the user.
    pub path: PathBuf,
}

impl Model {
    /// `base_from_device` of each station of some measurements, if the model is a calibration with all of them; else empty.
    #[must_use]
    pub fn devices_of(&self, data: &Dataset) -> Vec<Pose> {
        match &self.source {
            ModelSource::Calibration(file) => file.devices_of(data).unwrap_or_default(),
            ModelSource::Urdf(_) | ModelSource::Toml => Vec::new(),
        }
    }

    /// As [`CalibrationFile::left_error`], if the model is a calibration.
    #[must_use]
    pub fn left_error(&self) -> Option<RobotError> {
        match &self.source {
            ModelSource::Calibration(file) => file.left_error(),
            ModelSource::Urdf(_) | ModelSource::Toml => None,
        }
    }
}

/// Forms of robot models for output.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_results::model::ModelFormat;
/// # }
/// use poecal::ModelFormat;
/// assert_eq!(ModelFormat::of_path("out/robot.urdf"), Some(ModelFormat::Urdf));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelFormat {
    /// URDF.
    Urdf,
    /// TOML, as a table of screws.
    Toml,
}

impl ModelFormat {
    /// The form of a file's extension.
    #[must_use]
    pub fn of_path(path: impl AsRef<Path>) -> Option<Self> {
        match path.as_ref().extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "urdf" | "xml" | "xacro" => Some(ModelFormat::Urdf),
            "toml" => Some(ModelFormat::Toml),
            _ => None,
        }
    }

    /// The probable form of a text.
    fn of_text(text: &str) -> Self {
        match text.trim_start_matches('\u{feff}').trim_start().chars().next() {
            Some('<') => ModelFormat::Urdf,
            _ => ModelFormat::Toml,
        }
    }
}

impl Model {
    /// Reads a robot model, with the form by the file's extension, else by the beginning of the text. `selection` is for URDF.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if the file cannot be read; [`ErrorKind::Option`] if a chain is selected in a model that has only one, or an instrument or
    /// a target that it does not have; otherwise as the reader of its form.
    pub fn read(path: impl AsRef<Path>, selection: &ChainSelection) -> Result<Self> {
        Model::read_at(path.as_ref(), selection)
    }

    /// The part of reading that does not depend on the kind of path, compiled once.
    fn read_at(path: &Path, selection: &ChainSelection) -> Result<Self> {
        let text = source_text::read(path, MODEL)?;
        let beside = ForeignForm::from_text(&text, path).and_then(|form| form.sibling(&text, path));
        let Some(beside) = beside else { return Model::parse(&text, path, selection) };
        let table = source_text::read(
            &beside,
            "the controller's nominal table, without which calibration.conf states differences alone",
        )?;
        Model::parse_beside(&text, path, Some((&table, &beside)), selection)
    }

    /// A robot model from its text; messages name it `path`, whose extension determines the form, as for a file.
    ///
    /// # Errors
    /// As [`Model::read`].
    pub fn parse(text: &str, path: impl AsRef<Path>, selection: &ChainSelection) -> Result<Self> {
        Model::parse_beside(text, path.as_ref(), None, selection)
    }

    fn parse_beside(
        text: &str,
        path: &Path,
        beside: Option<(&str, &Path)>,
        selection: &ChainSelection,
    ) -> Result<Self> {
        if let Some(form) = ForeignForm::from_text(text, path) {
            let document = form.read(text, path, beside, selection)?;
            let robot = document.robot().clone();
            return Ok(Model { robot, source: ModelSource::Urdf(Box::new(document)), path: path.to_path_buf() });
        }
        if looks_like_json(path, text) {
            refuse_chain(path, selection)?;
            let file = CalibrationFile::parse(text, path)?;
            let robot = file.robot().map_err(|error| error.in_file(path))?;
            check_mounts(path, selection, &robot)?;
            let source = ModelSource::Calibration(Box::new(file));
            return Ok(Model { robot, source, path: path.to_path_buf() });
        }
        if let Some(error) = looks_like::table_for_model(text, path) {
            return Err(error);
        }
        let (robot, source) = match ModelFormat::of_path(path).unwrap_or(ModelFormat::of_text(text)) {
            ModelFormat::Urdf => {
                let urdf = UrdfDocument::parse(text, path, selection)?;
                (urdf.robot().clone(), ModelSource::Urdf(Box::new(urdf)))
            }
            ModelFormat::Toml => {
                refuse_chain(path, selection)?;
                let robot = robot_toml::parse(text, path)?;
                check_mounts(path, selection, &robot)?;
                (robot, ModelSource::Toml)
            }
        };
        Ok(Model { robot, source, path: path.to_path_buf() })
    }
}

impl Model {
    /// Mapping from the controller's counts to the readings of a calibration; `None` for other models, and if they are equal.
    #[must_use]
    pub fn controller(&self) -> Option<&Controller> {
        match &self.source {
            ModelSource::Calibration(file) => file.controller.as_ref(),
            ModelSource::Urdf(_) | ModelSource::Toml => None,
        }
    }

    /// The same mapping if some reading depends on more than one count.
    #[must_use]
    pub fn sums(&self) -> Option<&Controller> {
        self.controller().filter(|it| !it.is_plain())
    }

    /// Statements of its file about links and joints that are not read, or that other programs interpret differently, a sentence each.
    #[must_use]
    pub fn remarks(&self) -> &[String] {
        match &self.source {
            ModelSource::Urdf(document) => document.remarks(),
            ModelSource::Toml | ModelSource::Calibration(_) => &[],
        }
    }

    /// Values that seem to be in other units than those of its form, a sentence each.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        match &self.source {
            ModelSource::Urdf(document) => urdf::doubts(document, &self.robot),
            ModelSource::Toml | ModelSource::Calibration(_) => Vec::new(),
        }
    }

    /// Note that a new calibration starts from the axes of this one alone; `None` for other models, and for a calibration without joint terms.
    #[must_use]
    pub fn terms_left_out(&self) -> Option<String> {
        match &self.source {
            ModelSource::Calibration(file) => file.corrected_file().map(|_| {
                format!(
                    "{}: its calibrated axes are the nominal model; its joint terms are not taken over",
                    self.path.display()
                )
            }),
            ModelSource::Urdf(_) | ModelSource::Toml => None,
        }
    }

    /// Options that read files for this robot with its controller's counts.
    #[must_use]
    pub fn reads(&self, options: ReadOptions) -> ReadOptions {
        let beyond_tip = match &self.source {
            ModelSource::Urdf(document) => document.joints_beyond_tip().to_vec(),
            ModelSource::Toml | ModelSource::Calibration(_) => Vec::new(),
        };
        ReadOptions { controller: self.controller().cloned(), beyond_tip, ..options }
    }

    /// The URDF that was read, or calibrated; `None` for other models.
    pub(crate) fn document(&self) -> Result<Option<Cow<'_, UrdfDocument>>> {
        match &self.source {
            ModelSource::Urdf(document) => Ok(Some(Cow::Borrowed(document))),
            ModelSource::Calibration(file) => Ok(file.original_urdf(&self.path)?.map(Cow::Owned)),
            ModelSource::Toml => Ok(None),
        }
    }

    /// The text of a URDF with a robot that differs from the model's in numbers only, and the selection that reads the robot from it: the text
    /// that was read or calibrated, or else a new one.
    pub(crate) fn urdf_of(&self, robot: &Robot, notes: &mut Vec<String>) -> Result<(String, ChainSelection)> {
        match self.document()? {
            Some(document) => {
                let patched = document.patch(robot)?;
                notes.extend(patched.notes);
                Ok((patched.text, patched.selection))
            }
            None => {
                let (new, selection) = urdf::written_new(robot)?;
                notes.extend(new.notes);
                Ok((new.text, selection))
            }
        }
    }

    /// The corrected model of a calibration, if it has one; otherwise the same.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if the file holds no valid corrected model.
    pub fn corrected_model(self) -> Result<Self> {
        let ModelSource::Calibration(file) = &self.source else { return Ok(self) };
        let Some(corrected) = file.corrected_file() else { return Ok(self) };
        let robot = corrected.robot().map_err(|error| error.in_file(&self.path))?;
        Ok(Model { robot, source: ModelSource::Calibration(Box::new(corrected)), ..self })
    }
}

fn looks_like_json(path: &Path, text: &str) -> bool {
    let named = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    named || text.trim_start_matches('\u{feff}').trim_start().starts_with('{')
}

fn refuse_chain(path: &Path, selection: &ChainSelection) -> Result<()> {
    if selection.base_link.is_none() && selection.tip_link.is_none() {
        return Ok(());
    }
    Err(ErrorKind::Option
        .error("found --base-link or --tip-link, expected neither: this model has one chain only")
        .in_file(path))
}

/// Refuses instruments and targets that are not in a model without links.
fn check_mounts(path: &Path, selection: &ChainSelection, robot: &Robot) -> Result<()> {
    let instruments: Vec<&str> = robot.instruments.iter().map(|mount| mount.name.as_str()).collect();
    let mounted = robot.mounted.iter().map(|mount| mount.name.as_str());
    let targets: Vec<&str> = robot.targets.iter().map(|(name, _)| name.as_str()).chain(mounted).collect();
    for (what, named, known) in
        [("instrument", &selection.instruments, &instruments), ("target", &selection.targets, &targets)]
    {
        let Some((name, link)) = named.iter().find(|(name, _)| !known.contains(&name.as_str())) else {
            continue;
        };
        let known =
            if known.is_empty() { format!("it names no {what}") } else { format!("it has {}", first_few(known)) };
        return Err(ErrorKind::Option.error(format!(
            "found {what} `{name}` on link `{link}`, expected {what}s that the model names itself, since links are those of a URDF: {known}"
        )).in_file(path));
    }
    Ok(())
}

/// Writes a model in another form, reads it back and compares forward kinematics on 1,000 configurations.
///
/// # Errors
/// [`ErrorKind::Export`] if the form cannot hold the model, or the text read back differs by more than 1e-12 m or rad (for robots larger
/// than 1 m, 1e-12 of the size).
pub fn convert(model: &Model, to: ModelFormat) -> Result<ConvertedModel> {
    let robot = &model.robot;
    let mut plain = Cow::Borrowed(robot);
    let (converted, again) = match to {
        ModelFormat::Urdf => {
            let mut notes = Vec::new();
            plain = urdf::holdable(robot, &mut notes);
            let (text, selection) = model.urdf_of(&plain, &mut notes)?;
            let again = UrdfDocument::parse(&text, &model.path, &selection);
            (ConvertedModel { text, notes }, again.map(|document| document.robot().clone()))
        }
        ModelFormat::Toml => {
            let text = robot_toml::write(robot);
            let again = robot_toml::parse(&text, &model.path);
            (ConvertedModel { text, notes: toml_notes(model) }, again)
        }
    };
    let again = again
        .map_err(|error| export(model, format!("the converted model cannot be read back: {}", error.message())))?;
    verify(model, &plain, &again)?;
    Ok(converted)
}

fn toml_notes(model: &Model) -> Vec<String> {
    match &model.source {
        ModelSource::Urdf(_) => {
            vec![
                "link frames, fixed joints, meshes and inertias are not part of a TOML model and were left out"
                    .to_owned(),
            ]
        }
        ModelSource::Toml | ModelSource::Calibration(_) => Vec::new(),
    }
}

fn export(model: &Model, message: String) -> Error {
    ErrorKind::Export.error(message).in_file(&model.path)
}

/// Compares the forward kinematics of a model and of its text read back.
pub(crate) fn verify(model: &Model, robot: &Robot, again: &Robot) -> Result<()> {
    let names = |robot: &Robot| robot.joint_reading_names().into_iter().collect::<BTreeSet<_>>();
    let is_same = if model.robot.is_serial() {
        again.joint_reading_names() == model.robot.joint_reading_names()
    } else {
        names(again) == names(&model.robot)
    };
    if !is_same {
        return Err(export(model, "the converted model has other joints, expected the same".to_owned()));
    }
    let Difference { position_m, rotation_rad } = Difference::from_robots(robot, again, 1000);
    let tolerance_m = 1e-12 * model.robot.reach_m().max(1.0);
    if position_m <= tolerance_m && rotation_rad <= 1e-12 {
        return Ok(());
    }
    let message = format!(
        "the converted model differs by {position_m:.1e} m and {rotation_rad:.1e} rad, expected at most {tolerance_m:.1e} m and 1e-12 rad"
    );
    Err(export(model, message))
}
