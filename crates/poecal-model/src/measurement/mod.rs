//! Measurements by an external device: the table of measured functions, and the rows of a session.
//!
//! A row is a target, fixed to some body, that an instrument, fixed to some body, measures in a configuration, or in two. A measurement is a function
//! and its numbers. A `MeasurementFunction` (`function.rs`) has residual and sensitivity of the predicted pose of its target. It also has the motions of device
//! and target that it determines, its form in kernels, and the clue from which a fit starts in closed form. Its row in [`FUNCTIONS`] (`functions/`, a
//! file a sensor) adds its columns in files and the sessions that simulate and plan it. Files, words, templates, starts, kernels, diagnosis and
//! report use the row; none of them has a list of sensors.
//!
//! A function has channels, and each channel a quantity (`quantity.rs`: position, rotation, distance). Noise, robust scale, discrepancy, coverage and
//! accuracies are values [`ByQuantity`]. No code outside the table in `quantity.rs` matches on quantities, except code about a position or an
//! orientation, such as predictions. Pictures are beside the rows (`pictures.rs`). Joints, screws and parameters are elsewhere.

mod channels;
mod columns;
mod configurations;
mod dataset;
mod function;
mod functions;
mod instrument_noise;
mod known_length;
mod measured;
mod moving_rows;
mod noise_shape;
mod observability;
mod observation;
mod other_pose;
mod pictures;
mod quantity;
mod row_selection;
mod serial;
mod session;

pub use channels::{Channel, Channels, NUMBERS};
pub use columns::{FormCriterion, MeasurementColumns};
pub use configurations::MANY as MANY_ROWS;
pub use dataset::Dataset;
pub use function::{Device, InitialGuess, Kernel, MeasuredValues, MeasurementFunction, Sensitivity};
pub use functions::{FUNCTIONS, FunctionRow, find_by_quantities};
pub use instrument_noise::InstrumentNoise;
pub use known_length::KnownLength;
pub use measured::Measurement;
pub use moving_rows::{Clock, MovingRows};
pub use noise_shape::NoiseShape;
pub use observation::{Observation, RowLocation, Set};
pub use other_pose::{FormulatedMeasurement, PoseResidual};
pub use pictures::{SightingAbout, deviation, picture_whitening};
pub use quantity::{ByQuantity, MeasuredQuantities, Noise, Quantity, StatedDeviations};
pub use session::{MeasurementOrigin, RandomDraws, SessionKind, SessionTraits, StationLayout};
