//! What the library does, seen from outside: one program, since linking it once takes less than linking one for each subject.
//!
//! A test that needs a process of its own is a program of its own, beside this folder.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod arms;
mod basin;
mod blocks;
mod bundle;
mod calibration_file;
mod cell;
mod common;
mod compared;
mod compensation_map;
mod components;
mod corrections;
mod determinism;
mod documented_files;
mod drawing;
mod events;
mod export;
mod facade;
mod fast_path;
// Each crate uses what it needs of it.
mod field;
#[allow(dead_code)]
#[path = "../files/mod.rs"]
mod files;
mod fk_reference;
mod foreign_corners;
mod foreign_messages;
mod foreign_models;
mod forensics;
mod gauge;
mod identifiability;
mod jacobians;
#[path = "../largest/mod.rs"]
mod largest;
mod mapping_errors;
mod mapping_forms;
mod mapping_guess;
mod masses;
mod measurement_choices;
mod measurement_errors;
mod measurement_forms;
mod measurement_long;
mod misread_pictures;
mod mistakes;
mod mistakes_of_places;
mod mixed_cell;
mod model_convert;
mod model_errors;
mod modern_robotics;
mod motion;
mod moves;
mod noise_free;
mod offsets;
mod optics;
mod oracle;
mod pairing;
mod pictures;
mod programs;
mod promises;
mod quantities;
#[path = "../reference/mod.rs"]
mod reference;
mod refit_promise;
mod report_page;
mod report_places;
mod robust;
mod shapes;
mod shop;
mod singular;
mod stands;
mod starts;
mod stations;
mod statistics;
mod suspicion;
mod taught;
mod theory;
mod tip_bounds;
mod track;
mod tree_models;
#[allow(dead_code)]
#[path = "../trials/mod.rs"]
mod trials;
mod two_arms;
mod uncertainty;
mod unnamed_targets;
mod urdf_patch;
mod verdict;
