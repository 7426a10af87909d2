//! `poecal convert`: a model in another form.

use std::process::ExitCode;

use poecal::io::model::{self, Model, ModelFormat};
use poecal::{Error, ErrorKind, Result};

use crate::args::Convert;
use crate::console::Console;

pub(crate) fn convert(arguments: &Convert, console: &Console) -> Result<ExitCode> {
    let form = form(arguments)?;
    let model = Model::read(&arguments.model, &arguments.chain.selection())?;
    let converted = model::convert(&model, form)?;
    for note in &converted.notes {
        console.warning(note);
    }
    console.deliver(&converted.text, arguments.out.as_deref())?;
    Ok(ExitCode::SUCCESS)
}

fn form(arguments: &Convert) -> Result<ModelFormat> {
    let named = arguments.out.as_ref().and_then(ModelFormat::of_path);
    arguments.to.map(ModelFormat::from).or(named).ok_or_else(|| {
        let message = match &arguments.out {
            Some(out) => format!(
                "found no form in the name `{}`, expected .urdf or .toml, or --to urdf|toml",
                out.display()
            ),
            None => {
                "found neither --to nor --out, expected the form to write: --to urdf or --to toml".to_owned()
            }
        };
        Error::new(ErrorKind::Option, message)
    })
}
