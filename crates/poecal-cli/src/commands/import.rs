//! `poecal import`: measurements of any form as a table of poecal's own form, and the settings of their reading.

use std::fmt::Write as _;
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

use poecal_import as measurements;
use poecal_import::{FrameGrouping, Join, MeasurementFile, PlaneContact};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_storage::disk;
use poecal_storage::named_files::{canonical_path, refuse_repeats};

use super::models::read_model;
use crate::args::{CONTACT, FRAMES, Import, JOIN, word_of};
use crate::console::Console;
use crate::style::{label_paragraph, printable_path};

pub(crate) fn import(arguments: &Import, console: &Console) -> Result<u8> {
    let (Some(path), false) = (&arguments.model, arguments.measurements.is_empty()) else {
        return ErrorKind::Option.refuse(
            "found no measurements, expected `poecal import MODEL FILES… --out FILE`, or settings that name both",
        );
    };
    if !arguments.reading.meaning.instrument_noise.is_empty() {
        return ErrorKind::Option.refuse(
            "found --instrument-noise, expected it where the table is calibrated: it is no part of the measurements",
        );
    }
    if arguments.reading.meaning.join == Some(Join::Motion) {
        return ErrorKind::Option.refuse(
            "found --join motion, expected rows at rest: a table has no clock, whose lag is an unknown of the fit, so name the files in each command",
        );
    }
    let known = arguments.settings.as_deref().map_or_else(Vec::new, known_inputs);
    let meaning = arguments.reading.meaning.files();
    let inputs: Vec<&Path> =
        (std::iter::once(path).chain(&arguments.measurements).map(PathBuf::as_path)).chain(meaning).collect();
    refuse_repeats(&arguments.measurements)?;
    let existing = ExistingFiles::from_switch(arguments.force);
    let place = ReservedFile::reserve(&arguments.out, existing, &inputs, &mut console.warner())?;
    let beside = arguments.out.with_extension("map.toml");
    let map_place = ReservedFile::reserve(&beside, existing, &inputs, &mut console.warner())?;
    let options = arguments.reading.options()?;
    let model = read_model(path, &arguments.chain.selection(Some(&options))?, console)?;
    let file = measurements::read(&arguments.measurements, &model.robot, &model.reads(options))?;
    console.said_of(&file);
    let table = measurements::imported_table(&file, &model.robot)?;
    console.warnings(&describe_changed_files(&known, &file));
    let map = map(arguments, path, &file);
    place.write(vec![table.into()])?;
    map_place.write(vec![map.into()])?;
    let rows = file.data.len();
    let text = label_paragraph("written", &format!("{}, {}", printable_path(&arguments.out), printable_path(&beside)))
        + &label_paragraph("rows", &format!("{rows} of {} files", arguments.measurements.len()))
        + &label_paragraph(
            "calibrate",
            &format!("poecal calibrate {} {}", printable_path(path), printable_path(&arguments.out)),
        )
        + &label_paragraph("again", &format!("poecal import --settings {} --out FILE", printable_path(&beside)));
    Ok(console.say_of(&text, &arguments.out))
}

/// The interpretation of the files, as settings that read them again in the same form.
fn map(arguments: &Import, model: &Path, file: &MeasurementFile) -> String {
    let folder = arguments.out.parent().unwrap_or(Path::new(""));
    let here = |path: &Path| quote_toml(&relative_path(folder, path).display().to_string());
    let mut out = String::from(
        "# How the files of this table were read. The same files and these settings make it again, byte by byte:\n",
    );
    let _ = writeln!(
        out,
        "#   poecal import --settings {} --out FILE",
        shown_name(&arguments.out.with_extension("map.toml"))
    );
    out.push_str("poecal_settings = 1\n");
    let _ = writeln!(out, "model = {}", here(model));
    let files: Vec<String> = arguments.measurements.iter().map(|path| here(path)).collect();
    let _ = writeln!(out, "measurements = [{}]", files.join(", "));
    let mut text = |key: &str, value: Option<String>| {
        if let Some(value) = value {
            let _ = writeln!(out, "{key} = {value}");
        }
    };
    let (reading, chain) = (&arguments.reading, &arguments.chain);
    let meaning = &reading.meaning;
    text("base_link", chain.chain.base_link.as_deref().map(quote_toml));
    text("tip_link", chain.chain.tip_link.as_deref().map(quote_toml));
    let pairs = |pairs: &[(String, String)]| {
        let all: Vec<String> = pairs.iter().map(|(name, link)| quote_toml(&format!("{name}={link}"))).collect();
        (!all.is_empty()).then(|| format!("[{}]", all.join(", ")))
    };
    text("instrument", pairs(&chain.instrument));
    text("target", pairs(&chain.target));
    text("columns", meaning.columns.columns.as_deref().map(here));
    text("strict", meaning.strict.then(|| "true".to_owned()));
    text(
        "device_frames",
        (meaning.device_frames == FrameGrouping::PerFile).then(|| quote_toml(word_of(FRAMES, &meaning.device_frames))),
    );
    text("contact", (meaning.contact == PlaneContact::Flush).then(|| quote_toml(word_of(CONTACT, &meaning.contact))));
    text("train_where", reading.train_where.as_deref().map(quote_toml));
    // Recognised values are stated.
    text("join", meaning.join.or(file.join).map(|join| quote_toml(word_of(JOIN, &join))));
    let units = meaning.columns.units.clone().map_or_else(
        || file.is_in_degrees.then(|| "deg".to_owned()),
        |stated| Some(if file.is_in_degrees { format!("{stated},deg") } else { stated }),
    );
    text("units", units.as_deref().map(quote_toml));
    text("lag", meaning.lag.map(|lag| quote_toml(&format!("{}s+-{}s", lag.lag_s, lag.off_s))));
    text("sheet", meaning.sheet.as_deref().map(quote_toml));
    let topics: Vec<String> = meaning.topic.iter().map(|it| quote_toml(it)).collect();
    text("topic", (!topics.is_empty()).then(|| format!("[{}]", topics.join(", "))));
    text("body", meaning.body.as_deref().map(quote_toml));
    describe(&mut out, file);
    out
}

/// Adds the interpretation of each file, and the messages about it, as comments.
fn describe(out: &mut String, file: &MeasurementFile) {
    for understood in &file.understood {
        let form = understood.form.map(|it| format!(", {it}")).unwrap_or_default();
        let _ = writeln!(out, "\n# {}: {} rows{form}", understood.path.display(), understood.rows);
        if let Some(sha256) = file.sha256.get(&understood.path.display().to_string()) {
            let _ = writeln!(out, "{SHA256}{sha256}");
        }
        for column in &understood.columns {
            let from = column.column.as_deref().unwrap_or("a constant");
            let unit = column.unit.map(|unit| format!(" in {unit}")).unwrap_or_default();
            let _ = writeln!(out, "#   {} from {from}{unit}", column.name);
        }
        if let Some(orientation) = &understood.orientation {
            let _ = writeln!(out, "#   orientation: {orientation}, {}", understood.pose);
        }
    }
    if !file.notes.is_empty() || !file.warnings.is_empty() {
        out.push('\n');
    }
    for words in file.notes.iter().chain(&file.warnings) {
        let _ = writeln!(out, "# {words}");
    }
}

/// Names and checksums of the files that made a table, by the settings that were written beside it.
fn known_inputs(settings: &Path) -> Vec<(String, String)> {
    let mut text = String::new();
    // Their messages were printed before.
    if disk::current_disk().open(settings).and_then(|it| it.take(LARGEST).read_to_string(&mut text)).is_err() {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut name = None;
    for line in text.lines() {
        if let Some(sha256) = line.strip_prefix(SHA256) {
            found.extend(name.take().map(|it| (it, sha256.to_owned())));
        } else {
            name = line.strip_prefix("# ").and_then(|it| Some(it.rsplit_once(": ")?.0.to_owned()));
        }
    }
    found
}

/// Warnings of files that have changed since.
fn describe_changed_files(known: &[(String, String)], file: &MeasurementFile) -> Vec<String> {
    let base = |name: &str| Path::new(name).file_name().map(ToOwned::to_owned);
    let is_other = |(path, sha256): &(&String, &String)| {
        let mut same = known.iter().filter(|it| base(&it.0) == base(path)).peekable();
        same.peek().is_some() && same.all(|it| it.1 != **sha256)
    };
    let other = file.sha256.iter().filter(is_other);
    other
        .map(|(path, _)| {
            format!("{path}: it is not the file that the settings were made of: its checksum (SHA-256) is another")
        })
        .collect()
}

/// Largest settings, bytes.
const LARGEST: u64 = 1 << 24;

/// The comment with the checksum of a file.
const SHA256: &str = "#   SHA-256 ";

/// A text of TOML.
fn quote_toml(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn shown_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A path relative to a folder, with `/` in it.
fn relative_path(folder: &Path, path: &Path) -> PathBuf {
    let home = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let (home, whole) = (canonical_path(home), canonical_path(path));
    let (mut own, mut other) = (home.components().peekable(), whole.components().peekable());
    while own.peek().is_some() && own.peek() == other.peek() {
        own.next();
        other.next();
    }
    // There is no path to another drive.
    if own.clone().any(|part| matches!(part, Component::Prefix(_))) {
        return whole;
    }
    own.map(|_| Component::ParentDir).chain(other).collect()
}
