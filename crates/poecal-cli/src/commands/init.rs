//! `poecal init`: a project folder.

use poecal::Result;
use poecal::io::model::Model;
use poecal::io::output::{Contents, Existing, FolderPlace, Project, write_project};

use crate::args::Init;
use crate::console::Console;
use crate::style::{self, labelled, shown};

pub(crate) fn init(arguments: &Init, console: &Console) -> Result<u8> {
    let chain = arguments.chain.selection(None)?;
    let model = Model::read(&arguments.model, &chain)?;
    let project = Project {
        model: &model,
        chain: &chain,
        kind: arguments.measure,
        count: arguments.count as usize,
        seed: arguments.seed,
    };
    let (contents, existing) = (Contents::Project, Existing::Kept);
    let place = FolderPlace::reserve(&arguments.out, contents, existing, &[], &mut console.warner())?;
    let written = write_project(place, &project)?;
    console.warnings(&written.notes);
    let next = format!(
        "read {}: measure, fill in measurements.csv, and run `poecal calibrate` in that folder",
        shown(&written.folder.join("README.md"))
    );
    let words = style::written(&written.folder, &written.files) + &labelled("next", &next);
    Ok(console.say_of(&words, &written.folder))
}
