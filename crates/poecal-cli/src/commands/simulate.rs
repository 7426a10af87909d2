//! `poecal simulate`: a robot with known errors, and its measurements.

use poecal_calibrate::DeviceFrameKnowledge;
use poecal_model::robot::{Sizes, TermGroup};
use poecal_model::simulate::Simulation;
use poecal_numerics::error::Result;
use poecal_numerics::text::escape_invisible;
use poecal_results::output::{self, Contents, ExistingFiles, ReservedFolder, SimulatedSession};

use super::models::read_model;
use crate::args::{Simulate, TreeArgs};
use crate::console::Console;
use crate::style;

pub(crate) fn simulate(arguments: &Simulate, console: &Console) -> Result<u8> {
    let existing = ExistingFiles::from_switch(arguments.force);
    let place = ReservedFolder::reserve(
        &arguments.out,
        Contents::Simulation,
        existing,
        &[&arguments.model],
        &mut console.warner(),
    )?;
    let model = read_model(&arguments.model, &arguments.chain.selection(None)?, console)?;
    #[cfg(any(unix, windows))]
    if let Some(camera) = arguments.camera {
        return super::photograph::photograph((arguments, camera), (&model, place, &command(arguments)), console);
    }
    let simulation = Simulation {
        error_rotation_rad: arguments.errors.angle_rad,
        error_position_m: arguments.errors.length_m,
        noise_position_m: arguments.noise.length_m,
        noise_rotation_rad: arguments.noise.angle_rad,
        count: arguments.count as usize,
        seed: arguments.seed,
        device_anywhere: arguments.device_frame == DeviceFrameKnowledge::Unknown,
        terms: arguments.terms,
        gravity: arguments.gravity.into(),
    };
    let kind = arguments.kind;
    let made = simulation.run(&model.robot, kind)?;
    let held_out = match arguments.held_out_count {
        0 => None,
        count => Some(simulation.held_out(&made, kind, count as usize)?),
    };
    let command = command(arguments);
    let session =
        SimulatedSession { simulation: &simulation, kind, made: &made, held_out: held_out.as_ref(), command: &command };
    let written = output::write_simulation(place, &model, &session)?;
    console.warnings(&written.notes);
    Ok(console.say_of(&style::describe_written_files(&written.folder, &written.files), &written.folder))
}

/// The command that reproduces the files: all options that they depend on, and no output folder.
fn command(arguments: &Simulate) -> String {
    let TreeArgs { chain, instrument, target } = &arguments.chain;
    let mut words = vec!["poecal simulate".to_owned(), arguments.model.display().to_string()];
    for (option, link) in [("--base-link", &chain.base_link), ("--tip-link", &chain.tip_link)] {
        words.extend(link.as_ref().map(|link| format!("{option} {link}")));
    }
    for (option, named) in [("--instrument", instrument), ("--target", target)] {
        words.extend(named.iter().map(|(name, link)| format!("{option} {name}={link}")));
    }
    let (kind, count, seed) = (arguments.kind.word(), arguments.count, arguments.seed);
    #[cfg(any(unix, windows))]
    let kind = match arguments.camera {
        Some(camera) => format!("--camera {} --board {}", camera.word(), arguments.board),
        None => format!("--kind {kind}"),
    };
    #[cfg(not(any(unix, windows)))]
    let kind = format!("--kind {kind}");
    words.push(format!("{kind} --count {count} --seed {seed}"));
    words.push(format!("--errors {} --noise {}", arguments.errors.text, arguments.noise.text));
    if arguments.terms != Sizes::NONE {
        let used = TermGroup::ALL.into_iter().filter(|&group| arguments.terms[group] > 0.0);
        let used: Vec<String> = used.map(|group| format!("{}={:e}", group.name(), arguments.terms[group])).collect();
        let [x, y, z] = arguments.gravity;
        words.push(format!("--terms {} --gravity {x},{y},{z}", used.join(",")));
    }
    if arguments.device_frame == DeviceFrameKnowledge::Base {
        words.push("--device-frame base".to_owned());
    }
    if arguments.held_out_count > 0 {
        words.push(format!("--held-out-count {}", arguments.held_out_count));
    }
    // The command becomes one line of a file.
    escape_invisible(&words.join(" ")).into_owned()
}
