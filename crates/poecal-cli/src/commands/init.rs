//! `poecal init`: a project folder, or the mapping of a file's columns.

use std::path::Path;

use poecal_import::{ColumnGuess, guess_columns, pose_table};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_report as report;
use poecal_results::model::Model;
use poecal_results::output::{Contents, ExistingFiles, Project, ReservedFolder, write_project, write_texts};

use super::models::read_model;
use crate::DONE;
use crate::args::Init;
use crate::console::Console;
use crate::style::{self, label_paragraph, printable_path};

pub(crate) fn init(arguments: &Init, console: &Console) -> Result<u8> {
    if let Some(camera) = arguments.hand_eye {
        let words = format!("hand-eye {{}} --camera {}", camera.word());
        return table(arguments, ("poses.csv", pose_table(true)), &words, console);
    }
    if arguments.tcp {
        return table(arguments, ("touches.csv", pose_table(false)), "tcp {}", console);
    }
    let Some(path) = &arguments.model else {
        return ErrorKind::Option.refuse("found no model, expected `poecal init MODEL`, --hand-eye or --tcp");
    };
    let chain = arguments.chain.selection(None)?;
    let model = read_model(path, &chain, console)?;
    if let Some(file) = &arguments.columns_from {
        return columns(arguments, (path, file), &model, console);
    }
    let project = Project {
        model: &model,
        chain: &chain,
        kind: arguments.kind,
        count: arguments.count as usize,
        seed: arguments.seed,
    };
    let (contents, existing) = (Contents::Project, ExistingFiles::Kept);
    let place = ReservedFolder::reserve(&arguments.out, contents, existing, &[], &mut console.warner())?;
    let written = write_project(place, &project)?;
    console.warnings(&written.notes);
    console.warnings(&Vec::from_iter(model.robot.placeholder_limits()));
    let next = format!(
        "read {}: measure, fill in measurements.csv, and run `poecal calibrate` in that folder",
        printable_path(&written.folder.join("README.md"))
    );
    let words = style::describe_written_files(&written.folder, &written.files) + &label_paragraph("next", &next);
    Ok(console.say_of(&words, &written.folder))
}

/// Writes the mapping of a file's columns, and states its use.
fn columns(arguments: &Init, (model, file): (&Path, &Path), of: &Model, console: &Console) -> Result<u8> {
    let guess = guess_columns(file, &of.robot, &arguments.column)?;
    if arguments.json {
        console.data(&report::json(&guess)?)?;
        return Ok(DONE);
    }
    let place =
        ReservedFolder::reserve(&arguments.out, Contents::Project, ExistingFiles::Kept, &[], &mut console.warner())?;
    let ColumnGuess { mapping, missing, .. } = guess;
    let written = write_texts(place, ("columns.toml", mapping), Vec::new())?;
    if !missing.is_empty() {
        console.warning(format!(
            "found no column for {}, expected one for each: name it in the mapping",
            missing.join(", ")
        ));
    }
    let next = format!(
        "look it over, then poecal check {} {} --columns {}",
        printable_path(model),
        printable_path(file),
        printable_path(&written.folder.join("columns.toml"))
    );
    let words = style::describe_written_files(&written.folder, &written.files) + &label_paragraph("next", &next);
    Ok(console.say_of(&words, &written.folder))
}

/// Writes a table to fill, and names the command that reads it; `{}` is its path there.
fn table(arguments: &Init, (name, text): (&'static str, String), words: &str, console: &Console) -> Result<u8> {
    let (contents, existing) = (Contents::Project, ExistingFiles::Kept);
    let place = ReservedFolder::reserve(&arguments.out, contents, existing, &[], &mut console.warner())?;
    let written = write_texts(place, (name, text), Vec::new())?;
    let file = printable_path(&written.folder.join(name));
    let next = format!("fill in a row for each pose, and run `poecal {}`", words.replace("{}", &file));
    let words = style::describe_written_files(&written.folder, &written.files) + &label_paragraph("next", &next);
    Ok(console.say_of(&words, &written.folder))
}
