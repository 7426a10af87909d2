//! The pictures of a file as rows of the session.

use std::path::Path;

use super::gathering::BoardSighting;
use crate::read::MeasurementReader;
use crate::table::FileTable;
use crate::table::cursor::Cursor;
use crate::table::understanding::{ColumnUnderstanding, FileUnderstanding};
use poecal_fit::input_doubts::picture_sizes::check_sizes;
use poecal_model::camera::{Corner, FlatView, Picture, guessed_lens, is_flat_sheet};
use poecal_model::measurement::RowLocation;
use poecal_numerics::error::{Error, ErrorKind, Result, first_few};

impl MeasurementReader<'_> {
    /// Adds pictures as rows, each with the poses that fit its corners; pictures without such a pose are left out, and reported.
    pub(crate) fn take_pictures(&mut self, path: &Path, gathered: Vec<BoardSighting>) -> Result<()> {
        let file = u32::try_from(self.found.data.files.len().saturating_sub(1)).unwrap_or(u32::MAX);
        let (mut left_out, mut found) = (Vec::new(), 0);
        self.found.data.pictures.cameras.clone_from(&self.cameras);
        self.found.data.pictures.boards.clone_from(&self.boards);
        let pictures: Vec<(usize, &[Corner])> = gathered.iter().map(|it| (it.camera, it.corners.as_slice())).collect();
        let said = check_sizes(&self.cameras, &pictures).map_err(|it| it.error(ErrorKind::Measurement, path))?;
        self.warn(path, said);
        self.guess_lenses(&gathered)?;
        for one in gathered {
            let Some(taken) = one.taken else { continue };
            let name = one.image.clone().unwrap_or_else(|| format!("of line {}", taken.place.1));
            let id = if taken.id.is_empty() { one.image.clone().unwrap_or_default() } else { taken.id };
            let line = one.corners.first().map_or(0, |corner| corner.line);
            let picture = Picture::new(one.camera, one.board, one.image, one.corners);
            let data = &mut self.found.data;
            let pushed = data.push_picture(&taken.readings, picture, (taken.set, RowLocation { file, line }));
            let refused = |error: Error| ErrorKind::Measurement.error(error.message()).at_line(path, line as usize);
            if let Err(reason) = pushed.map_err(refused)? {
                left_out.push(format!("{name} ({reason})"));
                continue;
            }
            if !id.is_empty() || !data.ids.is_empty() {
                data.ids.resize(data.len() - 1, String::new());
                data.ids.push(id);
            }
            found += 1;
        }
        if !left_out.is_empty() {
            let (out, few) = (left_out.len(), first_few(&left_out));
            self.warn(path, [format!("left out {out} of {} pictures: {few}", out + found)]);
        }
        if found == 0 {
            let message = "found no picture with a pose, expected at least four corners of a board in a picture";
            return Err(ErrorKind::Measurement.error(message).in_file(path));
        }
        Ok(())
    }

    /// Estimates unknown lenses from the corners of flat boards.
    fn guess_lenses(&mut self, gathered: &[BoardSighting]) -> Result<()> {
        let pictures = &mut self.found.data.pictures;
        for (at, camera) in pictures.cameras.iter_mut().enumerate().filter(|(_, it)| it.is_guessed) {
            let view = |one: &BoardSighting| -> Option<FlatView> {
                let board = pictures.boards.get(one.board).filter(|board| is_flat_sheet(board))?;
                let of = |corner: &Corner| Some((board.points.get(corner.point as usize)?.xy(), corner.pixel));
                Some(one.corners.iter().filter_map(of).unzip())
            };
            let views: Vec<FlatView> = gathered.iter().filter(|one| one.camera == at).filter_map(view).collect();
            let size_px = camera.lens.size_px.unwrap_or([1, 1]);
            camera.lens = guessed_lens(size_px, &views).map_err(|found| ErrorKind::Measurement.error(found))?;
        }
        Ok(())
    }

    /// Records the interpretation of a file of corners.
    pub(crate) fn understand_pictures(
        &mut self,
        table: &FileTable<'_>,
        inputs: &Cursor<'_>,
        (first, rows, own): (usize, usize, Vec<ColumnUnderstanding>),
    ) -> Result<()> {
        let path = table.header.path;
        let pictures = self.found.data.len() - first;
        self.warn_of_ignored(path, &inputs.layout);
        self.take_controller(path, &inputs.layout)?;
        let mut understood = FileUnderstanding::new(table, inputs, rows);
        understood.columns.extend(own);
        understood.others.insert("pictures", pictures);
        self.found.understood.push(understood);
        Ok(())
    }
}
