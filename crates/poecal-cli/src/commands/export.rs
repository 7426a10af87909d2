//! `poecal export`: a robot in the forms of other programs.

use std::path::{Path, PathBuf};

use poecal_calibrate::AcceptedModel;
use poecal_formats::urdf::ChainSelection;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_results::export::{self, ExportFormat, ExportOptions};
use poecal_results::model::{Model, ModelFormat};
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source_text::read_up_to;

use super::joint_offsets::with_offsets;
use super::models::warn_of;
use crate::DONE;
use crate::args::{Export, ExportForm, INSTEAD};
use crate::console::Console;

/// The form by the output's name, or that of `--onto`.
fn by_name(arguments: &Export) -> Result<ExportFormat> {
    let out = arguments.place.out.as_ref();
    match out.and_then(ModelFormat::of_path) {
        _ if arguments.onto.is_some() => Ok(ExportFormat::Urdf),
        Some(ModelFormat::Urdf) => Ok(ExportFormat::Urdf),
        Some(ModelFormat::Toml) => Ok(ExportFormat::Toml),
        None => {
            let found = out.map_or_else(
                || "found no --format".to_owned(),
                |out| format!("found no form in the name `{}`", out.display()),
            );
            let words: Vec<&str> = ExportFormat::ALL.iter().map(|format| format.word()).collect();
            let message =
                format!("{found}, expected --out NAME.urdf or NAME.toml, or --format with one of {}", words.join(", "));
            ErrorKind::Option.refuse(message)
        }
    }
}

/// The form, with the options that it has.
fn format(arguments: &Export) -> Result<ExportFormat> {
    let format = match arguments.format {
        Some(ExportForm::Open(format)) => format,
        None => by_name(arguments)?,
        Some(ExportForm::Closed(why)) => {
            return ErrorKind::Option
                .refuse(format!("--format: found a form whose maker publishes no format for this ({why}): {INSTEAD}"));
        }
    };
    for (name, is_there, of) in [
        ("--onto", arguments.onto.is_some(), ExportFormat::Urdf),
        ("--hash", arguments.hash.is_some(), ExportFormat::Ur),
        ("--motors", arguments.motors.is_some(), ExportFormat::Lerobot),
    ] {
        if is_there && format != of {
            return ErrorKind::Option
                .refuse(format!("found {name} beside another form, expected it with --format {} alone", of.word()));
        }
    }
    Ok(format)
}

pub(crate) fn export(arguments: &Export, console: &Console) -> Result<u8> {
    let format = format(arguments)?;
    let further = arguments.onto.iter().chain(&arguments.motors);
    let inputs: Vec<&Path> = std::iter::once(&arguments.model).chain(further).map(PathBuf::as_path).collect();
    let place = arguments.place.reserve(&inputs, console)?;
    let selection = arguments.chain.selection(None)?;
    let is_calibration = arguments.model.extension().is_some_and(|it| it.eq_ignore_ascii_case("json"));
    let whole = ChainSelection::default();
    let is_whole = is_calibration && arguments.onto.is_some();
    let model = Model::read(&arguments.model, if is_whole { &whole } else { &selection })?;
    warn_of(&model, &arguments.model, console);
    let model = with_offsets(model, &arguments.offset, console)?;
    let model = if arguments.of == AcceptedModel::Corrected { model.corrected_model()? } else { model };
    if let Some(urdf) = &arguments.onto {
        let converted = export::write_onto(&model, urdf, &selection)?;
        console.warnings(&converted.notes);
        console.deliver(converted.text, place)?;
        return Ok(DONE);
    }
    let motors = arguments
        .motors
        .as_ref()
        .map(|path| read_up_to(path, "a calibration of motors (JSON)", ResourceLimit::Settings))
        .transpose()?;
    let options = ExportOptions { hash: arguments.hash.clone(), motors };
    let exported = export::export(&model, format, &options)?;
    let beside = match (&exported.beside, &arguments.place.out) {
        // No file is written beside a device.
        (Some(text), Some(out)) if out != Path::new("-") && !out.starts_with("/dev") => {
            let mut name = out.clone().into_os_string();
            name.push(".joints.json");
            let existing = ExistingFiles::from_switch(arguments.place.force);
            let place = ReservedFile::reserve(Path::new(&name), existing, &inputs, &mut console.warner())?;
            Some((text.clone(), place, PathBuf::from(name)))
        }
        _ => None,
    };
    console.warnings(&exported.notes);
    if exported.beside.is_some() && beside.is_none() {
        console.warning("what the joints do beyond geometry is in a file beside --out FILE, FILE.joints.json");
    }
    console.deliver(exported.text, place)?;
    if let Some((text, place, name)) = beside {
        console.deliver(text, Some(place))?;
        console.remark(format!("{} has what the joints do beyond geometry, with formulas", name.display()));
    }
    Ok(DONE)
}
