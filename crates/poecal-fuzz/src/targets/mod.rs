//! Fuzzed functions of bytes, which return true if the input was understood.

mod binary;
mod calibration;
mod lists;
mod mapping;
mod models;
mod pictures;
mod pipeline;
mod programs;
mod recorded;
mod residuals;
mod settings;
mod tables;

pub use binary::{bags, pictures, workbooks};
pub use calibration::{calibration, report};
pub use lists::{hand_eye, histories, ledgers, tcp};
pub use mapping::mapping;
pub use models::{foreign, robot_toml, urdf};
pub use pictures::{boards, cameras, messages};
pub use pipeline::pipeline;
pub use programs::programs;
pub use recorded::read_recorded;
pub use residuals::residuals;
pub use settings::settings;
pub use tables::{joints, measurements};
