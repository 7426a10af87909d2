//! A lens from a hand-eye calibration, in its JSON and as a file.

use serde::Serialize;

use poecal_fit::hand_eye::FoundLens;
use poecal_model::camera::PictureNumber;

/// A lens that was fitted with the frames.
#[derive(Serialize)]
pub(crate) struct LensEntry<'a> {
    numbers: Vec<LensNumberEntry<'a>>,
    known_bound95_mm: f64,
    apart: f64,
}

/// A number of a lens: as fitted, and by the pictures alone.
#[derive(Serialize)]
struct LensNumberEntry<'a> {
    name: &'a str,
    unit: &'a str,
    value: f64,
    sigma: f64,
    alone: f64,
    alone_sigma: f64,
}

impl<'a> LensEntry<'a> {
    pub(crate) fn new(lens: &'a FoundLens) -> Self {
        let number = |(found, alone): (&'a PictureNumber, &'a PictureNumber)| LensNumberEntry {
            name: lens_number_name(found),
            unit: &found.unit,
            value: found.found,
            sigma: found.deviation,
            alone: alone.found,
            alone_sigma: alone.deviation,
        };
        LensEntry {
            numbers: lens.numbers.iter().zip(&lens.alone).map(number).collect(),
            known_bound95_mm: 1e3 * lens.known_bound95_m,
            apart: lens.apart,
        }
    }
}

/// The short name of a number of a lens, as `fx`.
#[must_use]
pub fn lens_number_name(number: &PictureNumber) -> &str {
    number.name.rsplit('.').next().unwrap_or_default()
}

/// A lens as a file that `--lens` and `--camera` read.
pub(crate) fn lens_text(lens: &FoundLens) -> String {
    let [width, height] = lens.lens.size_px.unwrap_or_default();
    let of_lens = || lens.numbers.iter().filter(|it| it.unit != "mm");
    let names: String = of_lens().map(|it| format!("{},", lens_number_name(it))).collect();
    let values: String = of_lens().map(|it| format!("{},", it.found)).collect();
    format!("name,{names}width,height\ncamera,{values}{width},{height}\n")
}
