//! The corners of a file by picture, and the joint readings of each picture.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::picture_files::{ConfigurationsByImage, PictureConfiguration};
use crate::table::picture_names::PicturePartners;
use poecal_model::camera::{Board, Corner};
use poecal_numerics::error::{Error, ErrorKind, Result, first_few};

/// A board in a picture, with the corners that were read.
pub(crate) struct BoardSighting {
    /// The readings of the joints, unless another file has them.
    pub(crate) taken: Option<PictureConfiguration>,
    pub(crate) image: Option<String>,
    pub(crate) camera: usize,
    pub(crate) board: usize,
    pub(crate) corners: Vec<Corner>,
}

/// Line and column.
type TextPosition = (usize, usize);

/// Pictures of a file, in the order in which they begin.
#[derive(Default)]
pub(crate) struct PictureGathering {
    pub(crate) pictures: Vec<BoardSighting>,
    pub(crate) known: BTreeMap<(String, usize, usize), usize>,
    /// The numbers of the points of each board, with the first occurrence of each number.
    pub(crate) numbers: BTreeMap<usize, BTreeMap<u32, TextPosition>>,
    /// The first point of each board that has a name.
    pub(crate) named: BTreeMap<usize, (String, TextPosition)>,
}

impl PictureGathering {
    /// Assigns points to numbers: by the numbers in the names of the board, or from 1 if the file counts so. Returns a sentence on it.
    pub(crate) fn settle_numbers(&mut self, path: &Path, boards: &[Board]) -> Result<Option<String>> {
        let PictureGathering { pictures, numbers, named, .. } = self;
        let own: Vec<BTreeMap<u32, u32>> = boards.iter().map(Board::point_numbers).collect();
        let point = |board: usize, number: u32| own.get(board)?.get(&number).copied();
        let all = || numbers.iter().flat_map(|(at, all)| all.iter().map(|(number, place)| (*at, *number, *place)));
        let beyond = all().find(|(at, number, _)| point(*at, *number).is_none());
        let from = u32::from(beyond.is_some());
        let of = |board: usize, number: u32| point(board, number.checked_sub(from)?);
        if let Some((at, number, (line, column))) = beyond
            && all().any(|(at, number, _)| of(at, number).is_none())
            && let Some(board) = boards.get(at)
        {
            return Err(not_a_point(&number.to_string(), board).at_position(path, line, column));
        }
        let Some((at, number, _)) = all().next() else { return Ok(None) };
        if let Some((name, (line, column))) = named.get(&at) {
            let message = format!(
                "found the corner `{name}` beside ones that are numbered, as `{number}`, expected names or numbers alone"
            );
            return Err(ErrorKind::Measurement.error(message).at_position(path, *line, *column));
        }
        for picture in pictures.iter_mut().filter(|it| numbers.contains_key(&it.board)) {
            for corner in &mut picture.corners {
                corner.point = of(picture.board, corner.point).unwrap_or(corner.point);
            }
        }
        let name = of(at, number).and_then(|point| boards.get(at)?.names.get(point as usize));
        let name = name.map_or("", String::as_str);
        let first = own.get(at).and_then(|own| own.keys().next());
        let counted = match first {
            _ if from == 1 => "as counted from 1",
            Some(first) if *first < number => "as the board counts them (if they count from 1, write them as names)",
            _ => "as the board counts them",
        };
        Ok(Some(format!("took the numbers of corners for the points of the board, {counted}: `{number}` is `{name}`")))
    }

    /// Assigns joint readings of another file, which has `what` by picture, to the pictures. Names are equal, or have equal numbers at their end
    /// that no other picture has. Returns sentences on the pictures that were left out.
    pub(crate) fn join(&mut self, path: &Path, (others, what): (&ConfigurationsByImage, &str)) -> Result<Vec<String>> {
        let seen: BTreeSet<&String> = self.pictures.iter().filter_map(|it| it.image.as_ref()).collect();
        let partners = PicturePartners::new(&seen, others.keys().collect());
        let alike = partners.words("pictures", seen.len());
        let mut words: Vec<String> = alike.map(|it| format!("{it} of the {what}")).into_iter().collect();
        let unknown: Vec<&String> = seen.iter().copied().filter(|name| partners.partner(name).is_none()).collect();
        let used: BTreeSet<&String> = seen.iter().copied().chain(partners.alike.values().copied()).collect();
        let without: Vec<&String> = others.keys().filter(|name| !used.contains(name)).collect();
        if unknown.len() == seen.len()
            && let (Some(one), Some(other)) = (unknown.first(), without.first())
        {
            let message = format!(
                "found no picture that has {what}, as `{one}` beside `{other}`, expected the same names in both files, or ones that end in the \
                 same number, each once"
            );
            return Err(ErrorKind::Measurement.error(message).in_file(path));
        }
        for (names, which) in [(unknown, format!("corners and no {what}")), (without, format!("{what} and no corners"))]
        {
            if !names.is_empty() {
                let few = first_few(&names);
                words.push(format!("left out the pictures that have {which}: {} ({few})", names.len()));
            }
        }
        let taken = |sight: &BoardSighting| others.get(partners.partner(sight.image.as_ref()?)?).cloned();
        let taken: Vec<Option<PictureConfiguration>> = self.pictures.iter().map(taken).collect();
        for (picture, taken) in self.pictures.iter_mut().zip(taken) {
            picture.taken = taken;
        }
        self.pictures.retain(|it| it.taken.is_some());
        Ok(words)
    }
}

/// The error of a name that is no point of a board.
pub(crate) fn not_a_point(name: &str, board: &Board) -> Error {
    let message = format!(
        "found the corner `{name}`, expected one of the board's {}: {}",
        board.names.len(),
        first_few(&board.names)
    );
    ErrorKind::Measurement.error(message)
}
