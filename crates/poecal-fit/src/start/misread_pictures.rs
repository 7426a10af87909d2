//! Pictures that were saved mirrored, and readings that belong to the picture before or after. Both leave every picture with a pose, but no arm has
//! all of these poses.

use poecal_model::camera::{Corner, Lens, Picture};
use poecal_model::measurement::Dataset;

/// Error of the corners predicted by the nominal robot up to which the pictures count as right, pixels.
const LEAST_PX: f64 = 5.0;
/// Factor by which the error must be smaller if the pictures are read otherwise.
const EVIDENT: f64 = 2.0;
/// Largest number of pictures that are read otherwise, and fewest that are enough.
const MOST: usize = 60;
const FEWEST: usize = 6;

/// Statement that pictures are mirrored, or have the readings of another picture. `px` is the median error of the nominal robot on them,
/// pixels; `missed` computes that of another session.
pub(crate) fn find_misreading(data: &Dataset, px: f64, missed: impl Fn(&Dataset) -> f64) -> Option<String> {
    let count = data.pictures.all.len();
    // Further rows would be moved too.
    if px < LEAST_PX || count < FEWEST || count != data.len() {
        return None;
    }
    let plain = |corner: &Corner, _: &Lens| *corner;
    let told = |at: usize, by: isize| at.checked_add_signed(by).filter(|&at| at < count.min(MOST));
    let own = if count > MOST { missed(&read(data, |at| told(at, 0), plain)?) } else { px };
    let is_evident = |other: f64| other * EVIDENT < own && other.is_finite();
    let mirrored = |corner: &Corner, lens: &Lens| {
        let mut corner = *corner;
        corner.pixel.x = 2.0 * lens.centre_px[0] - corner.pixel.x;
        corner
    };
    let other = missed(&read(data, |at| told(at, 0), mirrored)?);
    if is_evident(other) {
        return Some(format!(
            "the pictures look mirrored: with left and right exchanged the nominal robot misses half of them by less than {other:.1} px, as they \
             are {own:.1} px; save them as the camera sees them, without the mirror of a selfie camera"
        ));
    }
    for (by, whose) in [(-1, "before"), (1, "after")] {
        let other = missed(&read(data, |at| told(at, by), plain)?);
        if is_evident(other) {
            return Some(format!(
                "each picture seems to have been taken with the readings of the picture {whose} it: so the nominal robot misses half of them by less \
                 than {other:.1} px, as they are {own:.1} px; join pictures and readings by name, and let the arm stand when both are taken"
            ));
        }
    }
    None
}

/// The pictures with the readings of others, whose number `whose` returns, and with other corners; those without readings are left out.
fn read(
    data: &Dataset,
    whose: impl Fn(usize) -> Option<usize>,
    corner: impl Fn(&Corner, &Lens) -> Corner,
) -> Option<Dataset> {
    let mut found = Dataset::new(data.reading_names().to_vec());
    found.pictures.cameras.clone_from(&data.pictures.cameras);
    found.pictures.boards.clone_from(&data.pictures.boards);
    found.pictures.sigma_px = data.pictures.sigma_px;
    for (at, picture) in data.pictures.all.iter().enumerate() {
        let Some(other) = whose(at).and_then(|at| data.pictures.all.get(at)) else { continue };
        let lens = &data.pictures.cameras.get(picture.camera)?.lens;
        let corners = picture.corners.iter().map(|it| corner(it, lens)).collect();
        let picture = Picture::new(picture.camera, picture.board, picture.image.clone(), corners);
        let observation = data.observations.get(data.pictures.all.get(at)?.row as usize)?;
        let readings = data.readings(other.row as usize).to_vec();
        // A picture without a pose is left out.
        let _ = found.push_picture(&readings, picture, (observation.set, observation.source)).ok()?;
    }
    (found.pictures.all.len() >= FEWEST).then_some(found)
}
