//! Sessions whose pictures leave something undetermined, which must be named, and clean ones, which must raise no warning.

use poecal_calibrate::BlockChoice;
use poecal_calibrate::CalibrationOptions;
use poecal_fit::start::settle_pictures;
use poecal_model::camera::{Board, Camera, Lens};
use poecal_model::simulate::{PictureSimulation, Simulation, elbow};
use poecal_numerics::error::Error;
use serde_json::{Value, json};

use crate::session::{calibrate_session, rebuild_pictures, simulation};

/// A kind of session: its name, the form of its pictures, and true if the lens is free.
struct SessionCase {
    name: &'static str,
    is_free: bool,
    of: fn(PictureSimulation) -> PictureSimulation,
}

/// A lens of this focal length in pixels, whose picture has a size.
fn lens(focal_px: f64, size_px: [u32; 2]) -> Lens {
    let centre = size_px.map(|size| 0.5 * f64::from(size) - 0.5);
    Lens { size_px: Some(size_px), ..Lens::pinhole([focal_px; 2], centre) }
}

const KINDS: [SessionCase; 8] = [
    SessionCase { name: "clean", is_free: false, of: |it| it },
    SessionCase { name: "clean, free lens", is_free: true, of: |it| it },
    SessionCase { name: "parallel", is_free: false, of: |it| PictureSimulation { tilt_rad: [0.0, 0.03], ..it } },
    SessionCase {
        name: "one axis",
        is_free: false,
        of: |it| PictureSimulation { turns: false, tilt_rad: [-0.7, 0.7], ..it },
    },
    SessionCase {
        name: "one part",
        is_free: false,
        of: |it| PictureSimulation { part: [[0.2, 0.4], [0.2, 0.4]], distance_m: [1.2, 1.6], ..it },
    },
    SessionCase {
        name: "focal length",
        is_free: true,
        of: |it| PictureSimulation { tilt_rad: [0.0, 0.01], distance_m: [0.8, 0.801], ..it },
    },
    SessionCase {
        name: "centre",
        is_free: true,
        of: |it| PictureSimulation {
            lens: lens(1500.0, [320, 240]),
            board: Board::chessboard("board", [7, 5], 0.006).unwrap_or_default(),
            ..it
        },
    },
    SessionCase {
        name: "lens of a part",
        is_free: true,
        of: |it| PictureSimulation { part: [[0.2, 0.4], [0.2, 0.4]], distance_m: [1.2, 1.6], ..it },
    },
];

/// Pictures of a session.
const COUNT: usize = 40;

pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    KINDS.iter().map(|kind| line(seed, kind)).collect()
}

fn line(seed: u64, kind: &SessionCase) -> Result<Value, Error> {
    let usual = simulation(seed.is_multiple_of(2), 0.0, 7000 + seed);
    let usual = (kind.of)(PictureSimulation { session: Simulation { count: COUNT, ..usual.session }, ..usual });
    let other = Simulation { seed: usual.session.seed + 1_000_000, ..usual.session };
    let made = usual.run(&elbow()).or_else(|_| PictureSimulation { session: other, ..usual.clone() }.run(&elbow()))?;
    let camera = Camera { is_guessed: false, ..made.data.pictures.cameras[0].clone() };
    let mut data = rebuild_pictures(&made.data, 0..COUNT, (&[camera], &made.data.pictures.boards))?;
    let start = settle_pictures(&mut data, &made.nominal).all();
    let free = if kind.is_free { vec!["lens".to_owned()] } else { Vec::new() };
    let options =
        CalibrationOptions { blocks: BlockChoice { free, ..BlockChoice::default() }, ..CalibrationOptions::default() };
    let mut line =
        json!({ "task": "degenerate", "seed": seed, "kind": kind.name, "in_hand": usual.in_hand, "start": start });
    match calibrate_session(&made.nominal, &data, &options) {
        Ok((calibration, _)) => {
            line["said"] = json!(calibration.warnings);
            line["determined"] = json!([calibration.identifiability.rank, calibration.identifiability.parameters]);
            line["level"] = json!(calibration.verdict.level.words());
            line["reasons"] = json!(format!("{:?}", calibration.verdict));
        }
        Err(error) => line["refused"] = json!(error.to_string()),
    }
    Ok(line)
}
