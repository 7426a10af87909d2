//! Columns of files of pictures: their meanings, and their names in HALCON, OpenCV and scripts around them.

use super::boards::Coordinate;
use crate::table::header::Header;
use crate::table::header_cells::{HeaderCell, unit_in_name};
use crate::table::inputs::ValueRange;
use crate::table::kinds;
use crate::table::mapping::ColumnMap;
use crate::table::roles::{ColumnRole, plain_letters};
use crate::table::understanding::ColumnUnderstanding;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::unit::Unit;

/// Columns of a file of corners.
#[derive(Clone, Debug)]
pub(crate) struct CornerColumns {
    pub(crate) u: usize,
    pub(crate) v: usize,
    pub(crate) sigma: Option<usize>,
    /// The name of the corner.
    pub(crate) name: Option<usize>,
    /// Its position on the board.
    pub(crate) place: Option<[Coordinate; 3]>,
    pub(crate) camera: Option<usize>,
    pub(crate) board: Option<usize>,
    pub(crate) image: Option<usize>,
}

/// Letters and digits of a column's name, in small letters, with `px` behind them if that is its unit.
fn key(cell: &HeaderCell) -> String {
    let name = plain_letters(&cell.name);
    let short = ["pixels", "pixel"].iter().find_map(|end| name.strip_suffix(end));
    let name = short.filter(|start| !start.is_empty()).map_or(name.clone(), |start| format!("{start}px"));
    if cell.units().any(is_pixel) && !name.ends_with("px") { format!("{name}px") } else { name }
}

/// The column with the first name of a list, unless it is a joint's; a second column of this name is an error.
fn column(
    header: &Header<'_>,
    names: impl IntoIterator<Item = &'static str>,
    joints: &[String],
) -> Result<Option<usize>> {
    let keys: Vec<String> = header.cells.iter().map(key).collect();
    for name in names {
        let is_it = |key: &String| key == name || key.strip_suffix("px") == Some(name);
        let cells = header.cells.iter().zip(&keys).enumerate();
        let mut found = cells.filter(|(_, (cell, key))| is_it(key) && !joints.contains(&cell.name)).map(|(at, _)| at);
        let Some(first) = found.next() else { continue };
        let Some(second) = found.next() else { return Ok(Some(first)) };
        let message = format!(
            "found a second column `{}` beside `{}`, expected one; rename or remove one of them",
            header.text(second),
            header.text(first)
        );
        return Err(header.error(ErrorKind::Measurement, second, message));
    }
    Ok(None)
}

/// True if a file has columns with measurements of other devices, or a mapping names them.
fn is_measured(header: &Header<'_>, map: &ColumnMap) -> bool {
    let has = |name: &str| header.cells.iter().any(|cell| cell.name == name && !key(cell).ends_with("px"));
    let position = ["x", "y", "z"].iter().all(|name| has(name));
    let is_vector = header.cells.iter().any(|cell| key(cell) == "pz");
    let numbers = kinds::kinds().filter(|kind| kind.needs_numbers()).flat_map(|kind| kind.columns.numbers);
    let is_other = numbers.copied().any(has);
    position || is_vector || is_other || map.position.is_some() || !map.targets.is_empty()
}

/// The columns of the pixel; those with another name than ours only if nothing else is measured.
fn pixels(header: &Header<'_>, joints: &[String], map: &ColumnMap) -> Result<Option<[usize; 2]>> {
    if header.count("u") > 0 && header.count("v") > 0 {
        return Ok(header.find("u")?.zip(header.find("v")?).map(<[usize; 2]>::from));
    }
    if is_measured(header, map) {
        return Ok(None);
    }
    let mut found: Option<[usize; 2]> = None;
    for (u, v) in ColumnRole::Pixel.rows().filter_map(|names| names.split_once(' ')) {
        let both = column(header, [u], joints)?.zip(column(header, [v], joints)?);
        if let (Some([first, _]), Some((second, _))) = (found, both) {
            let message = format!(
                "found the pixel in column `{}` and again in `{}`, expected it once: call the two columns that are meant u[px] and v[px]",
                header.text(first),
                header.text(second)
            );
            return Err(header.error(ErrorKind::Measurement, second, message));
        }
        found = found.or(both.map(<[usize; 2]>::from));
    }
    Ok(found)
}

/// True if the columns of a file are those of corners.
pub(crate) fn are_corners(header: &Header<'_>, joints: &[String], map: &ColumnMap) -> Result<bool> {
    pixels(header, joints, map).map(|found| found.is_some())
}

/// True if a file has joint readings by picture, and no measurements.
pub(crate) fn are_readings_of_pictures(header: &Header<'_>, joints: &[String], map: &ColumnMap) -> bool {
    let without = |names: &[&str]| names.iter().all(|name| header.count(name) == 0);
    let has_picture =
        header.count("image") > 0 || !is_measured(header, map) && picture(header, joints).is_ok_and(|it| it.is_some());
    has_picture
        && without(&["u", "v", "x", "y", "z"])
        && are_corners(header, joints, map).is_ok_and(|are_corners| !are_corners)
}

/// The column of the picture's name.
pub(crate) fn picture(header: &Header<'_>, joints: &[String]) -> Result<Option<usize>> {
    column(header, ColumnRole::Picture.words().chain(ColumnRole::Frame.words()), joints)
}

/// The columns of the position on the board.
fn place(header: &Header<'_>) -> Result<Option<[Coordinate; 3]>> {
    let before = ColumnRole::OnBoard.words().flat_map(|word| [format!("{word}_"), word.to_owned()]);
    let found = std::iter::once(String::new()).chain(before).find_map(|before| {
        let of = ["x", "y", "z"].map(|axis| of_length(header, &format!("{before}{axis}")));
        let [Some(x), Some(y), Some(z)] = of else { return None };
        Some([x, y, z])
    });
    let Some([x, y, z]) = found else { return Ok(None) };
    Ok(Some([x?, y?, z?]))
}

/// A column of a length with this name, except for its case and unit.
fn of_length(header: &Header<'_>, name: &str) -> Option<Result<Coordinate>> {
    let named = |cell: &HeaderCell| {
        let is_it = cell.name.eq_ignore_ascii_case(name) && !key(cell).ends_with("px");
        let unit = unit_in_name(&cell.name, name).filter(|unit| unit.si_unit() == Unit::Metre);
        is_it.then_some(NamedUnit::from(Unit::Metre)).or(unit)
    };
    let (at, unit) = header.cells.iter().enumerate().find_map(|(at, cell)| Some((at, named(cell)?)))?;
    let stated = header.unit(at, Unit::Metre, "for a point of the board");
    Some(stated.map(|stated| (at, stated.map_or(unit, |(unit, _)| unit))))
}

/// True if a column may equally count rows.
fn is_count(header: &Header<'_>, at: usize) -> bool {
    header.cells.get(at).is_some_and(|cell| ["id", "index"].contains(&key(cell).as_str()))
}

/// True if a unit is that of pixels.
fn is_pixel(unit: &str) -> bool {
    ["px", "pixel", "pixels"].contains(&unit.to_lowercase().as_str())
}

impl CornerColumns {
    /// The columns of a file of corners; `has_boards` is true if boards are stated, whose points have names.
    pub(crate) fn new(
        header: &Header<'_>,
        joints: &[String],
        (map, has_boards): (&ColumnMap, bool),
    ) -> Result<Option<Self>> {
        let Some([u, v]) = pixels(header, joints, map)? else { return Ok(None) };
        let sigma = column(header, ColumnRole::PixelSigma.words(), joints)?;
        for column in [Some(u), Some(v), sigma].into_iter().flatten() {
            if !header.cells.get(column).is_some_and(|cell| cell.units().all(is_pixel)) {
                header.only_unit(column, "px")?;
            }
        }
        let place = place(header)?;
        let name = match column(header, ColumnRole::Corner.words(), joints)? {
            // A column that counts rows, if the file states the positions of the corners.
            Some(at) if place.is_some() && is_count(header, at) => None,
            name => name,
        };
        if name.is_none() && place.is_none() {
            header.require("target", "for the name of the corner", |_| false, "")?;
        }
        Ok(Some(CornerColumns {
            u,
            v,
            sigma,
            name,
            place: place.filter(|_| name.is_none() || !has_boards),
            camera: column(header, ColumnRole::Camera.words(), joints)?,
            board: column(header, ColumnRole::Board.words(), joints)?,
            image: picture(header, joints)?,
        }))
    }

    /// The column in which the corner is named, for messages.
    pub(crate) fn corner(&self) -> usize {
        let place = || self.place.map(|[(at, _), ..]| at);
        self.name.or_else(place).unwrap_or(self.u)
    }

    /// Meaning and column of each.
    pub(crate) fn all(&self) -> Vec<(&'static str, usize)> {
        let mut all = vec![("u", self.u), ("v", self.v)];
        let (names, more) = (
            ["sigma", "target", "image", "camera", "board"],
            [self.sigma, self.name, self.image, self.camera, self.board],
        );
        all.extend(names.into_iter().zip(more).filter_map(|(name, at)| Some((name, at?))));
        let place = self.place.iter().flatten().map(|(at, _)| *at);
        all.extend(["point x", "point y", "point z"].into_iter().zip(place));
        all
    }

    /// True if the column of the picture has our name, so that its rows have one configuration.
    pub(crate) fn names_pictures(&self, header: &Header<'_>) -> bool {
        self.image.and_then(|at| header.cells.get(at)).is_some_and(|cell| cell.name == "image")
    }

    /// The meaning of columns whose name is not ours, in words; `None` if all are ours.
    pub(crate) fn words(&self, header: &Header<'_>) -> Option<String> {
        let is_foreign = |(name, at): &(&str, usize)| header.cells.get(*at).is_some_and(|cell| cell.name != *name);
        let foreign = self.all().into_iter().filter(is_foreign);
        let words: Vec<String> = foreign.map(|(name, at)| format!("`{}` for {name}", header.text(at))).collect();
        (!words.is_empty()).then(|| format!("took {}", words.join(", ")))
    }

    /// Interpretation of the columns, for `poecal check`; `seen` are smallest and largest u, v and standard deviation.
    pub(crate) fn describe_columns(&self, header: &Header<'_>, seen: &[ValueRange; 3]) -> Vec<ColumnUnderstanding> {
        let of = |(name, at): (&'static str, usize)| {
            let pixel = ["u", "v", "sigma"].into_iter().zip(seen).find(|it| it.0 == name).map(|it| it.1);
            let place = self.place.iter().flatten().find(|(own, _)| *own == at);
            let unit = pixel.map(|_| "px").or(place.map(|(_, unit)| unit.symbol()));
            let (cell, range) = (header.cells.get(at), pixel.and_then(|it| it.0));
            let is_stated = cell.is_some_and(|cell| cell.units().next().is_some());
            ColumnUnderstanding {
                name: name.to_owned(),
                column: cell.map(|cell| cell.text.clone()),
                unit,
                unit_from: unit.filter(|_| is_stated).map(|_| UnitSource::Header),
                min: range.map(|(min, _)| min),
                max: range.map(|(_, max)| max),
            }
        };
        self.all().into_iter().map(of).collect()
    }
}
