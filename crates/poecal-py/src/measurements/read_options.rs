//! Options of a reader, from the arguments of functions in Python.

use std::path::PathBuf;

use poecal_import::{ColumnMap, FrameGrouping, Join, PlaneContact, ReadOptions};

/// Options of a reader, from the arguments of the same names.
pub(super) fn options(
    columns: Option<&PathBuf>,
    train_where: Option<&str>,
    [ignore_sets, strict]: [bool; 2],
    (frames, join, lag): (FrameGrouping, Option<Join>, Option<&str>),
    (socket_distance, contact): (Option<&str>, PlaneContact),
    [units, sheet, body]: [Option<&str>; 3],
    [instrument_noise, cameras, markers, topics]: [Option<&[String]>; 4],
) -> poecal_numerics::error::Result<ReadOptions> {
    let mut options = ReadOptions {
        frames,
        join,
        lag: lag.map(str::parse).transpose()?,
        sheet: sheet.map(str::to_owned),
        body: body.map(str::to_owned),
        topics: topics.unwrap_or_default().to_vec(),
        mapping: columns.map(ColumnMap::read).transpose()?,
        train_where: train_where.map(str::parse).transpose()?,
        ignore_sets,
        strict,
        socket_distances: socket_distance.map(str::parse).transpose()?,
        contact,
        instrument_noise: instrument_noise.into_iter().flatten().map(|it| it.parse()).collect::<Result<_, _>>()?,
        ..ReadOptions::default()
    };
    if let Some(units) = units {
        options.state_units(units)?;
    }
    for typed in cameras.unwrap_or_default() {
        options.add_cameras(typed)?;
    }
    for typed in markers.unwrap_or_default() {
        options.add_boards(typed)?;
    }
    Ok(options)
}
