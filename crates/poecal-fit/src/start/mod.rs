//! Device frame and targets without an initial guess, with nominal screws (theory.md §6, *Start*).

mod averaging;
mod faces;
mod hand_eye;
mod markers;
mod misread_pictures;
mod one_station;
mod pairing;
mod pictures;
mod placeless_devices;
mod registration;
mod robust;
mod stations;
mod zeros;

pub(crate) use averaging::rotation_maximising;
pub use averaging::{mean_rotation, rigid_motion};
pub use faces::{faces_on_known_planes, settle_faces};
pub use markers::{FEWEST_MARKERS, MarkerPositions, RenamedMarkers};
pub use pairing::{
    Agreement, AlignedPairs, EVIDENT, FEWEST_PAIRS, JointStream, LagFailure, LaggedMeasurements, LaggedPairs,
    MeasuredStands, MotionEntry, MotionMeasurements, MotionRecording, MovingRow, ResampledStream, RowOrder, RowPair,
    RowStream, StaticInterval, StreamChannels, StreamFailure, TimeInterval, UnpairedRows, mm, motion_of_points,
    motion_of_target, number_lines, numbered_as, smooth_times, stands_of_measured, stands_of_readings,
};
pub use pictures::{SolvedPictures, predicted_pose, settle_pictures};
pub use registration::{
    Registration, clock_parameters, device_parameter, free_parameters, range_parameters, register_again,
    target_parameters,
};
pub use robust::{register_robustly, row_distances};
pub use stations::register;
pub(crate) use stations::register_roughly;
pub use zeros::{JointZeros, find_zeros};
