//! A robot model, with the statements of its file that are not read.

use std::path::Path;

use poecal_formats::urdf::ChainSelection;
use poecal_numerics::error::Result;
use poecal_results::model::Model;

use crate::console::Console;

/// Reads a model, and warns of statements of its file about links and joints that are not read, or that other programs interpret differently.
pub(super) fn read_model(path: &Path, selection: &ChainSelection, console: &Console) -> Result<Model> {
    let model = Model::read(path, selection)?;
    warn_of(&model, path, console);
    Ok(model)
}

/// The warnings of [`read_model`].
pub(super) fn warn_of(model: &Model, path: &Path, console: &Console) {
    for remark in model.remarks() {
        console.warning(format!("{}: {remark}", path.display()));
    }
}
