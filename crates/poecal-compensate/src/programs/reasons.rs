//! Reasons for which the engine leaves a target unchanged.

pub(crate) const NO_MOTION: &str =
    "no motion of this file goes there: its tool and frame are not known, so correct it with the file that moves to it";
pub(crate) const NO_TOOL: &str = "the tool is not known: state it by --tool-data";
pub(crate) const NO_FRAME: &str = "the frame is not known: state it by --work-object";
pub(crate) const TWO_PLACES: &str = "it is used with several tools or frames: make a target for each";
pub(crate) const TWO_WAYS: &str = "it is reached in several configurations: make a target for each";
pub(crate) const NOTHING_STATED: &str = "the program states no configuration, and the one before is not known: state where the robot starts by --start, or begin with a joint target";
pub(crate) const WAY: &str =
    "the way to it passes a singularity, or leaves the nominal robot's reach or limits: make it a joint target";
pub(crate) const UNREACHABLE: &str =
    "the nominal robot does not reach it: check --tool-data, --work-object, --controller-base and --controller-flange";
pub(crate) const NONE_FITS: &str = "no configuration of the nominal robot fits the one that is stated: check it, --controller-base and --controller-flange";
pub(crate) const SEVERAL_FIT: &str =
    "several configurations of the nominal robot fit the one that is stated: make it a joint target";
pub(crate) const NOT_SURE: &str =
    "it is not sure which configuration is the nearest to the one before: make it a joint target";
pub(crate) const OTHER: &str =
    "the configuration that is stated is not the one to which the motion before leads: check both";
pub(crate) const SINGULAR: &str = "it is at a singularity: make it a joint target";
pub(crate) const LIMITS: &str = "it is beyond the limits once corrected: move it";
pub(crate) const WORDS: &str =
    "the corrected target is in a configuration that the program states otherwise: make it a joint target";
pub(crate) const JOINTS: &str = "poses are corrected of robots with six joints or fewer: make it a joint target";
pub(crate) const NO_BRANCHES: &str =
    "all configurations of a pose are known of robots with six turning joints alone: make it a joint target";
pub(crate) const NOT_A_POSE: &str = "its numbers are no pose";
