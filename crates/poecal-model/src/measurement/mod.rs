//! Measurements by an external device: the table of what is measured, and the rows of a session.

mod channels;
mod columns;
mod configurations;
mod dataset;
mod function;
mod functions;
mod joined;
mod known_length;
mod measured;
mod moving;
mod noise_shape;
mod observation;
mod other_pose;
mod pictures;
mod quantity;
mod serial;
mod session;
mod shown;

pub use channels::{Channel, Channels, NUMBERS};
pub use columns::{Columns, From};
pub use configurations::MANY as MANY_ROWS;
pub use dataset::Dataset;
pub use function::{Clue, Device, Function, Kernel, Sensitivity, Values};
pub use functions::{FUNCTIONS, Row, measuring};
pub use known_length::KnownLength;
pub use measured::Measurement;
pub use moving::{Clock, Moving};
pub use noise_shape::NoiseShape;
pub use observation::{Observation, Set, Source};
pub use other_pose::{PoseResidual, Written};
pub use pictures::{SightingAbout, deviation, picture_whitening};
pub use quantity::{ByQuantity, Measured, Noise, Quantity, Stated};
pub use session::{Draw, Drawn, Kind, Session, Stands};
