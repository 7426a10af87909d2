//! Options with a few words as values: the help of each word and its meaning for the library. Command line and Python package read the same tables.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use poecal_calibrate::{AcceptedModel, DeviceFrameKnowledge, Level, Loss, Repairs, RobustLoss};
use poecal_compensate::Language;
use poecal_fit::hand_eye::CameraMounting;
use poecal_import::{FrameGrouping, Join, PlaneContact};
use poecal_lou2009::{Method, PaperFormulation, PaperResidual};
use poecal_model::robot::ThirdAxis;
use poecal_model::simulate::SessionKind;
use poecal_plan::plan::PlanCriterion;
use poecal_results::export::ExportFormat;
use poecal_results::iso9283::TestFrame;
use poecal_results::predictions::PredictionFrame;

/// Words, each with its help and its meaning.
pub type WordList<T> = &'static [(&'static str, &'static str, T)];

/// The word of a meaning; empty if it has none.
pub(crate) fn word_of<T: PartialEq>(words: WordList<T>, meaning: &T) -> &'static str {
    words.iter().find(|(.., it)| it == meaning).map_or("", |(word, ..)| word)
}

/// Knowledge of the measuring device's frame.
pub const FRAME: WordList<DeviceFrameKnowledge> = &[
    ("unknown", "The device frame is unknown", DeviceFrameKnowledge::Unknown),
    ("base", "Measurements are in the robot's base frame", DeviceFrameKnowledge::Base),
];

/// The frame in which accuracy of a test is stated.
pub const TEST_FRAME: WordList<TestFrame> = &[
    ("unknown", "It is fitted to the barycentres, which makes AP smaller", TestFrame::Unknown),
    ("base", "Measurements are in the robot's base frame", TestFrame::Base),
    ("calibration", "The device stands where the calibration has it", TestFrame::Calibration),
];

/// Position of the camera of simulated pictures: on the arm or beside it.
#[cfg(any(unix, windows))]
pub const CAMERA: WordList<CameraMounting> = &[
    ("in-hand", "On the tip, and the board stays", CameraMounting::InHand),
    ("beside", "Beside the robot, and the board is on the tip", CameraMounting::Beside),
];

/// Position of the camera of a hand-eye calibration: on the arm or beside it.
pub const HAND_EYE_CAMERA: WordList<CameraMounting> = &[
    ("in-hand", "On the flange, and the target stays", CameraMounting::InHand),
    ("beside", "Beside the robot, and the target is on the flange", CameraMounting::Beside),
];

/// Inversion of the arm's poses.
pub const FLANGE_POSES: WordList<bool> = &[
    ("base-from-flange", "The flange in the base, as controllers show it", false),
    ("flange-from-base", "The base in the flange", true),
];

/// Inversion of the target's poses.
pub const TARGET_POSES: WordList<bool> = &[
    ("camera-from-target", "The target as the camera sees it, as OpenCV's rvec and tvec", false),
    ("target-from-camera", "The camera in the target's frame", true),
];

/// State of the device: unmoved or moved.
pub const DEVICE: WordList<bool> = &[
    ("refit", "It was set up anew: its frame is fitted, and a shift of the first joint does not show", false),
    ("known", "It stands where it stood, as on fixed nests", true),
];

/// State of the tool: unchanged or mounted anew.
pub const TOOL: WordList<bool> = &[
    ("same", "It stayed on the flange, or was mounted on pins", false),
    ("refit", "It was mounted anew: its targets are fitted, and a shift of the last joint does not show", true),
];

/// Sets of rows that share a device frame.
pub const FRAMES: WordList<FrameGrouping> = &[
    ("common", "All, or those of one name in the column `instrument`", FrameGrouping::Common),
    ("per-file", "Those of a file", FrameGrouping::PerFile),
];

/// Methods of joining two files.
pub const JOIN: WordList<Join> = &[
    ("name", "By the names of their rows (`id`), or the numbers at the end of these", Join::Name),
    ("rows", "By their order; where their numbers differ, by what the nominal robot misses by least", Join::Rows),
    ("time", "By the times of their stands, each file with a clock of its own", Join::Time),
    (
        "motion",
        "By their times, while the robot moves: lag and drift of the clocks are unknowns of the fit",
        Join::Motion,
    ),
];

/// Zeros of the counts of third axes.
pub const THIRD_AXIS: WordList<ThirdAxis> = &[
    ("level", "From the level: where J2 turns alone, the forearm keeps its direction", ThirdAxis::Level),
    ("arm", "From the lower arm, as joint 3 of a model", ThirdAxis::Arm),
];

/// Methods of touching planes.
pub const CONTACT: WordList<PlaneContact> = &[
    ("point", "By a point: a height", PlaneContact::Point),
    ("flush", "By a face that lies flush: a height and two tilts", PlaneContact::Flush),
];

/// Parameterisations of the joints' errors.
pub const FORMULATION: WordList<PaperFormulation> = &[
    ("adjoint", "Axes move as rigid bodies, without offsets: minimal, unconstrained", PaperFormulation::Adjoint),
    ("screw", "Screws are free numbers, normalised after every step", PaperFormulation::Screw),
    ("screw-offsets", "Free screws and joint offsets, 7n + 6 unknowns", PaperFormulation::ScrewOffsets),
    ("adjoint-offsets", "Axes as rigid bodies, and joint offsets", PaperFormulation::AdjointOffsets),
];

/// Residuals of measured frames.
pub const RESIDUAL: WordList<PaperResidual> = &[
    ("tool", "Position and rotation at the target", PaperResidual::Tool),
    ("spatial", "The twist about the device's origin", PaperResidual::Spatial),
];

/// Method of the solver.
pub const METHOD: WordList<Method> = &[
    ("levenberg-marquardt", "Damped steps, taken only if they reduce the cost", Method::LevenbergMarquardt),
    ("gauss-newton", "Full steps, taken as they are", Method::GaussNewton),
];

/// Treatments of outliers.
pub const ROBUST: WordList<RobustLoss> = &[
    ("auto", "Least squares, unless outliers are evident: then the tukey loss, and a warning", RobustLoss::Auto),
    ("off", "Least squares: every row counts in full", RobustLoss::Off),
    ("huber", "The influence of a residual is bounded", RobustLoss::Loss(Loss::Huber)),
    ("cauchy", "The influence of a large residual decreases with its size", RobustLoss::Loss(Loss::Cauchy)),
    ("tukey", "Large residuals have no influence", RobustLoss::Loss(Loss::Tukey)),
];

/// Repair of a session: on or off.
pub const REPAIR: WordList<Repairs> = &[
    ("auto", "What evidently happened is repaired, if other rows are predicted better then", Repairs::Auto),
    ("off", "It is said only", Repairs::Off),
];

/// The verdicts that can be required.
pub const REQUIRED_LEVEL: WordList<Level> = &[
    ("good", "Good to use anywhere within the limits", Level::Good),
    ("inside_sampled_range", "Good to use inside the sampled range, or better", Level::InsideSampledRange),
    (
        "measured_configurations",
        "Good to use in configurations like those measured, or better",
        Level::MeasuredConfigurations,
    ),
    ("located", "Targets and devices are located with the axes held, or better", Level::Located),
];

/// The frame of predicted poses.
pub const PREDICT_IN: WordList<PredictionFrame> = &[
    ("base", "The robot's base", PredictionFrame::Base),
    ("device", "The measuring device of a calibration", PredictionFrame::Device),
];

/// Model of a calibration that predicts, or that shall keep limits.
pub const MODEL: WordList<AcceptedModel> = &[
    ("corrected", "Screws and terms of the joints", AcceptedModel::Corrected),
    ("calibrated", "Geometry alone, as a URDF holds it", AcceptedModel::Calibrated),
];

/// Form of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramLanguage {
    /// A table of joint readings.
    Table,
    /// A robot program.
    Robot(Language),
}

/// Forms of a program.
pub const LANGUAGE: WordList<ProgramLanguage> = &[
    ("csv", "A table of joint readings", ProgramLanguage::Table),
    ("urscript", "URScript of Universal Robots (.script)", ProgramLanguage::Robot(Language::UrScript)),
    ("rapid", "RAPID of ABB (.mod, .prg, .sys)", ProgramLanguage::Robot(Language::Rapid)),
    ("krl", "KRL of KUKA (.src, .dat)", ProgramLanguage::Robot(Language::Krl)),
    ("fanuc", "A program of FANUC as text (.ls)", ProgramLanguage::Robot(Language::Fanuc)),
];

/// A form, or one that cannot be written, with the reason.
#[derive(Clone, Copy, Debug)]
pub enum ExportForm {
    /// A form that can be written.
    Open(ExportFormat),
    /// A form that cannot be written, with the reason.
    Closed(&'static str),
}

/// A form, by its word.
const fn public_form(format: ExportFormat, help: &'static str) -> (&'static str, &'static str, ExportForm) {
    (format.word(), help, ExportForm::Open(format))
}

/// A form that is not public, with the reason why no file of it can be written.
const fn private_form(word: &'static str, why: &'static str) -> (&'static str, &'static str, ExportForm) {
    (word, why, ExportForm::Closed(why))
}

/// Parser of the forms of exports: only those that can be written are offered.
pub(crate) fn export_form() -> impl TypedValueParser<Value = ExportForm> {
    let value = |(word, help, form): &(&'static str, &'static str, ExportForm)| {
        PossibleValue::new(*word).help(*help).hide(matches!(form, ExportForm::Closed(_)))
    };
    parser_of_values(EXPORT_FORMAT.iter().map(value).collect(), EXPORT_FORMAT.to_vec())
}

/// Help of the form, with those that cannot be written.
pub(crate) fn export_form_help() -> String {
    let closed = EXPORT_FORMAT.iter().filter_map(|(word, _, form)| match form {
        ExportForm::Closed(why) => Some(format!("{word} ({why})")),
        ExportForm::Open(_) => None,
    });
    let closed = closed.collect::<Vec<_>>().join(", ");
    format!("The form. No file can be written for {closed}: {INSTEAD}")
}

/// Advice for a controller whose form is not public.
pub(crate) const INSTEAD: &str = "use --format offsets for mastering and `poecal compensate` for programs";

/// The forms of exports, also those that cannot be written.
const EXPORT_FORMAT: WordList<ExportForm> = &[
    public_form(ExportFormat::Urdf, "The URDF that was calibrated, with other numbers"),
    public_form(ExportFormat::Toml, "A table of screws, which poecal reads"),
    public_form(ExportFormat::Poe, "Screws of a product of exponentials, JSON"),
    public_form(ExportFormat::Dh, "Denavit and Hartenberg's table, JSON"),
    public_form(ExportFormat::Mdh, "Craig's table, JSON"),
    public_form(
        ExportFormat::Hayati,
        "Denavit and Hartenberg's, with Hayati's rows where axes are nearly parallel, JSON",
    ),
    public_form(ExportFormat::Origins, "Origins of the joints by name, YAML for xacro"),
    public_form(ExportFormat::Ur, "Universal Robots' driver, YAML"),
    public_form(ExportFormat::Xarm, "uFactory's description, YAML"),
    public_form(ExportFormat::Franka, "Franka's description, YAML"),
    public_form(ExportFormat::Pal, "PAL Robotics' master calibration, YAML"),
    public_form(ExportFormat::Lerobot, "LeRobot's calibration of motors, JSON"),
    public_form(ExportFormat::Mjcf, "MuJoCo's model"),
    public_form(ExportFormat::Sdf, "Gazebo's model"),
    public_form(ExportFormat::Usd, "USD physics, as Isaac Sim reads it"),
    public_form(ExportFormat::Csv, "Origins of the joints, a row each"),
    public_form(ExportFormat::Offsets, "The joint offsets, base and tool that come nearest, JSON"),
    public_form(ExportFormat::Tf, "What was located, camera or tool and board or device: ROS 2, URDF, quaternions"),
    public_form(ExportFormat::C, "Arrays of C for kinematics on a controller, with what joints do"),
    private_form("kuka", "KUKA's absolute accuracy is a file on the robot's own memory"),
    private_form("fanuc", "FANUC's geometry is closed, and mastering needs counts of encoders"),
    private_form("staubli", "Staeubli's arm.cfx accepts the maker's numbers only"),
    private_form("yaskawa", "Yaskawa shows neither geometry nor its corrections"),
    private_form("abb", "the frames and signs of ABB's MOC.cfg are not published"),
];

/// Values of words that the library knows: the help and the meaning of each.
fn parser_of_words<T: Clone + Send + Sync + 'static>(
    words: Vec<(&'static str, &'static str, T)>,
) -> impl TypedValueParser<Value = T> {
    let values = words.iter().map(|(word, help, _)| PossibleValue::new(*word).help(*help)).collect();
    parser_of_values(values, words)
}

/// Parser of words that are offered by these values.
fn parser_of_values<T: Clone + Send + Sync + 'static>(
    values: Vec<PossibleValue>,
    words: Vec<(&'static str, &'static str, T)>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(values).try_map(move |chosen| {
        let found = words.iter().find(|(word, ..)| *word == chosen);
        found.map(|(.., meaning)| meaning.clone()).ok_or("expected one of the words")
    })
}

/// Parser of some kinds of measurement, each also by its plural.
fn kinds(some: Vec<SessionKind>) -> impl TypedValueParser<Value = SessionKind> {
    let value = |kind: &SessionKind| {
        let value = PossibleValue::new(kind.word()).help(kind.session().help);
        kind.session().plural.map_or(value.clone(), |plural| value.alias(plural))
    };
    let values: Vec<PossibleValue> = some.iter().map(value).collect();
    PossibleValuesParser::new(values).try_map(move |chosen| {
        let is_it = |kind: &&SessionKind| kind.word() == chosen || kind.session().plural == Some(chosen.as_str());
        some.iter().find(is_it).copied().ok_or("expected one of the words")
    })
}

/// Parser of a simulated device's kind of measurement.
pub(crate) fn parser_of_simulated() -> impl TypedValueParser<Value = SessionKind> {
    kinds(SessionKind::all().into_iter().collect())
}

/// Parser of a session's kind of measurement.
pub(crate) fn parser_of_measured() -> impl TypedValueParser<Value = SessionKind> {
    kinds(SessionKind::all().into_iter().filter(|kind| kind.session().plural.is_some()).collect())
}

/// The frames and targets that a validation refits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefitChoice {
    /// The frame of the device.
    Device,
    /// The targets.
    Tool,
    /// The frame of the device if the rows show that it moved.
    Auto,
}

/// The frames and targets that a validation refits.
pub const REFIT: WordList<RefitChoice> = &[
    ("device", "The frame of the device, which was set up again", RefitChoice::Device),
    ("tool", "The targets, which were mounted again", RefitChoice::Tool),
    ("auto", "The frame of the device where it stands elsewhere", RefitChoice::Auto),
];

/// Frames of a robot beside its joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OuterFrame {
    /// The base frame.
    Base,
    /// The tip frame.
    Tip,
}

/// Frames of a robot beside its joints.
pub const OUTER_FRAME: WordList<OuterFrame> =
    &[("base", "The base frame", OuterFrame::Base), ("tip", "The tip frame", OuterFrame::Tip)];

/// Purpose of a planned list.
pub const CRITERION: WordList<PlanCriterion> = &[
    (
        "expected",
        "Expected errors of the calibrated and the corrected model over the workspace",
        PlanCriterion::Expected,
    ),
    ("D", "Determinant of the information of geometry", PlanCriterion::D),
    ("A", "Mean variance of the unknowns of geometry", PlanCriterion::A),
    ("E", "Largest variance of the unknowns of geometry", PlanCriterion::E),
    ("G", "Largest variance of a prediction in the workspace", PlanCriterion::G),
];

/// Avoidance of collisions of the robot with itself.
pub const SELF_COLLISION: WordList<bool> = &[
    ("avoid", "Configurations in which links overlap are left out", true),
    ("ignore", "Shapes are not looked at", false),
];

/// Parser of one of these words for clap.
pub(crate) fn one_of<T: Copy + Send + Sync + 'static>(words: WordList<T>) -> impl TypedValueParser<Value = T> {
    parser_of_words(words.to_vec())
}
