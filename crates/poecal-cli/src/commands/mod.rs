//! The commands, one per file (and `typed`, the command line of a run, which several need).

mod calibrate;
mod certificate;
mod check;
mod check_history;
mod compare;
mod compensate;
mod export;
#[cfg(any(unix, windows))]
mod fleet;
mod frames;
mod hand_eye;
mod identify;
mod import;
mod init;
mod iso9283;
mod joint_offsets;
mod models;
mod offsets;
#[cfg(any(unix, windows))]
mod pictures;
mod plan;
mod predict;
mod program_commands;
mod report;
mod reproducing_command;
mod simulate;
mod tcp;
mod track;
mod validate;
mod visits;
mod watch;

#[cfg(any(unix, windows))]
use pictures::{detect, photograph};

use program_commands::{completions, man, reproduce, schema};

pub(crate) use calibrate::calibrate;
pub(crate) use check::check;
pub(crate) use compare::compare;
pub(crate) use compensate::compensate;
pub(crate) use completions::completions;
#[cfg(any(unix, windows))]
pub(crate) use detect::detect;
pub(crate) use export::export;
#[cfg(any(unix, windows))]
pub(crate) use fleet::fleet;
pub(crate) use hand_eye::hand_eye;
pub(crate) use import::import;
pub(crate) use init::init;
pub(crate) use iso9283::iso9283;
pub(crate) use man::man;
pub(crate) use offsets::offsets;
pub(crate) use plan::plan;
pub(crate) use predict::predict;
pub(crate) use report::report;
pub(crate) use reproduce::reproduce;
pub(crate) use schema::schema;
pub(crate) use simulate::simulate;
pub(crate) use tcp::tcp;
pub(crate) use track::track;
pub(crate) use validate::validate;
pub(crate) use watch::watch;
