//! Device frame and targets without an initial guess, with nominal screws (theory.md §6, *Start*).

mod averaging;
mod faces;
mod hand_eye;
mod markers;
mod misread;
mod one_station;
mod others;
mod pairing;
mod pictures;
mod registration;
mod robust;
mod stations;

pub(crate) use averaging::rotation_maximising;
pub use averaging::{mean_rotation, rigid_motion};
pub use faces::{faces_on_known_planes, settle_faces};
pub use markers::{FEWEST_MARKERS, MarkerPlaces, RenamedMarkers};
pub use pairing::{
    Agreement, Aligned, AtLag, Channels as StreamChannels, EVIDENT, FEWEST_PAIRS, InMotion, JointStream,
    Lagged, MeasuredStands, Motion, MotionEntry, MovingRow, NoLag, NoStream, Order, Pair, Sampled, Span,
    Stand, Stream, Unpaired, mm, motion_of_points, motion_of_target, numbered, numbered_as, smoothed,
    stands_of_measured, stands_of_readings,
};
pub use pictures::{SettledPictures, predicted_pose, settle_pictures};
pub use registration::{
    Registration, clock_parameters, device_parameter, free_parameters, range_parameters, register_again,
    target_parameters,
};
pub use robust::{register_robustly, row_distances};
pub use stations::register;
pub(crate) use stations::register_roughly;
