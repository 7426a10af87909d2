//! A robot model, with what its file states beyond what is read.

use std::path::Path;

use poecal_formats::urdf::ChainSelection;
use poecal_numerics::error::Result;
use poecal_results::model::Model;

use crate::console::Console;

/// Reads a model, and warns of what its file states of links and joints that is not read, or that others understand differently.
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
