//! Unknowns that the pictures of a camera cannot determine, for any robot (theory.md §4, *Pictures*).

use crate::run::pixels::predicted_picture;
use crate::steps::calibrated_fit::CalibratedFit;
use poecal_model::camera::{CameraViews, PictureUnknown, is_flat_sheet};
use poecal_numerics::error::shorten_name;

/// Angle to the image below which a board is parallel to it, rad.
const PARALLEL_RAD: f64 = 0.1;
/// Turn about further axes (root mean square) below which a board turns about one axis only, rad.
const ONE_AXIS_RAD: f64 = 0.05;
/// Share of width or height of the image within which corners are in one part of it.
const PART: f64 = 0.4;
/// Standard deviations above which focal lengths (relative) and the centre (relative to the width) are undetermined: half of the prior knowledge of
/// any lens.
const FOCAL: f64 = 0.01;
const CENTRE: f64 = 0.01;

/// A sentence for each quantity that the pictures of a camera leave undetermined, with advice.
pub(crate) fn view_doubts(fit: &CalibratedFit<'_>) -> Vec<String> {
    let cameras = 0..fit.run.data.pictures.cameras.len();
    cameras.flat_map(|camera| CameraFit::new(fit, camera).map(|it| it.doubts()).unwrap_or_default()).collect()
}

/// A camera with the views of its fitted pictures.
struct CameraFit<'a> {
    fit: &'a CalibratedFit<'a>,
    camera: usize,
    name: String,
    views: CameraViews,
    /// True if all its boards are flat.
    is_flat: bool,
}

impl<'a> CameraFit<'a> {
    /// The views of a camera; `None` without pictures.
    fn new(fit: &'a CalibratedFit<'a>, camera: usize) -> Option<Self> {
        let data = &fit.run.data;
        let pictures = &data.pictures;
        let mut views = CameraViews { poses: vec![Vec::new(); pictures.boards.len()], ..CameraViews::default() };
        let rows = fit.run.fit_rows.iter().copied().filter(|row| !fit.robust.robustness.suspects_row(*row));
        let rows: Vec<u32> = rows.filter(|row| pictures.index_of_row(*row).is_some()).collect();
        // Poses as the robot predicts them: a single picture hardly determines the tilt of a board seen from the front.
        let errors = fit.session().errors(&rows, &fit.robust.fitted.estimate);
        for (row, error) in rows.iter().zip(&errors) {
            let (picture, pose) = predicted_picture(data, *row, error)?;
            if picture.camera != camera {
                continue;
            }
            views.poses.get_mut(picture.board)?.push(pose);
            views.pixels.extend(picture.corners.iter().map(|corner| corner.pixel));
        }
        let mut seen = pictures.boards.iter().zip(&views.poses).filter(|(_, poses)| !poses.is_empty());
        let is_flat = seen.all(|(board, _)| is_flat_sheet(board));
        let name = shorten_name(&pictures.cameras.get(camera)?.name).into_owned();
        (!views.pixels.is_empty()).then_some(CameraFit { fit, camera, name, views, is_flat })
    }

    fn doubts(&self) -> Vec<String> {
        [self.describe_parallel_views(), self.one_axis(), self.one_part(), self.focal_length(), self.centre()]
            .into_iter()
            .flatten()
            .collect()
    }

    fn has_free_lens(&self) -> bool {
        self.fit.run.unknowns.pictures.contains(&PictureUnknown::Lens(self.camera))
    }

    fn describe_parallel_views(&self) -> Option<String> {
        let tilt = self.views.largest_tilt();
        (self.is_flat && tilt < PARALLEL_RAD).then(|| {
            format!(
                "the board is parallel to the image of the camera `{}` in all pictures, to {:.1} deg: these say little of the tilt of board and \
                 camera, and a longer lens looks like a nearer board; tilt the board by 20 to 45 deg in half of the pictures",
                self.name,
                tilt.to_degrees()
            )
        })
    }

    fn one_axis(&self) -> Option<String> {
        let [most, others] = self.views.turns().map(f64::to_degrees);
        if self.views.poses.iter().all(|it| it.len() < 2) || others > ONE_AXIS_RAD.to_degrees() {
            return None;
        }
        let found = format!(
            "from picture to picture of the camera `{}` the board turns about one axis only ({most:.0} deg, about others {others:.1} deg, RMS): \
             where camera and board are along this axis cannot be seen",
            self.name
        );
        Some(if self.has_parallel_axes() {
            format!("{found}, whatever the configurations: the robot's turning axes are parallel")
        } else {
            format!("{found}; turn the board about a second axis too, by 20 deg or more")
        })
    }

    /// True if the robot can turn about one direction only.
    fn has_parallel_axes(&self) -> bool {
        let turning = || self.fit.run.robot.joints.iter().filter(|joint| !joint.screw.is_prismatic());
        let Some(first) = turning().next().map(|joint| joint.screw.direction()) else { return true };
        turning().all(|joint| joint.screw.direction().cross(&first).norm() < ONE_AXIS_RAD)
    }

    fn one_part(&self) -> Option<String> {
        let camera = self.fit.run.data.pictures.cameras.get(self.camera)?;
        let size = camera.lens.size_px?.map(f64::from);
        let [[left, right], [top, bottom]] = self.views.extent_px();
        let [width, height] = size;
        if right - left > PART * width && bottom - top > PART * height {
            return None;
        }
        let consequence = if self.has_free_lens() {
            "the lens that was found is that of this part"
        } else {
            "nothing is known of the lens elsewhere"
        };
        Some(format!(
            "the corners are in one part of the image of the camera `{}`: columns {left:.0} to {right:.0} of {width:.0}, rows {top:.0} to {bottom:.0} \
             of {height:.0}: {consequence}; take pictures with the board at all sides of the image",
            self.name
        ))
    }

    /// Standard deviation of a number of the lens, if it is free.
    fn deviation(&self, number: &str) -> Option<f64> {
        let pictures = &self.fit.run.data.pictures;
        let name = format!("lens.{}.{number}", pictures.cameras.get(self.camera)?.name);
        pictures.found.iter().find(|it| it.name == name).map(|it| it.deviation)
    }

    fn focal_length(&self) -> Option<String> {
        let [fx, fy] = self.fit.run.data.pictures.cameras.get(self.camera)?.lens.focal_px;
        let share = (self.deviation("fx")? / fx).max(self.deviation("fy")? / fy);
        (share > FOCAL).then(|| {
            format!(
                "the focal lengths of the camera `{}` are found to ±{:.1} % only: a longer lens and a board that is farther away look the same in \
                 these pictures; take some at half the distance, with the board tilted by 20 to 45 deg, or state the lens",
                self.name,
                100.0 * share
            )
        })
    }

    fn centre(&self) -> Option<String> {
        let size = self.fit.run.data.pictures.cameras.get(self.camera)?.lens.size_px;
        let width = size.map(|[width, _]| f64::from(width))?;
        let off_px = self.deviation("cx")?.max(self.deviation("cy")?);
        (off_px > CENTRE * width).then(|| {
            format!(
                "the centre of the lens of the camera `{}` is found to ±{off_px:.0} px only: a turn of the camera where it is mounted looks the same \
                 in these pictures; fill the image with the board, tilted, or state the lens",
                self.name
            )
        })
    }
}
