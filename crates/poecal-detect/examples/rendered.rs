//! Draws pictures of boards with their truth, finds the corners, and prints their number and accuracy: `rendered [PICTURES [FOLDER]]`. The pictures
//! and the truth are written to the folder, for other detectors; `-` is none. Missing and inaccurate corners are printed beside the table.

#![allow(clippy::print_stderr)]

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use cpu_time::ThreadTime;
use nalgebra::Vector2;
use poecal_detect::render::{DrawnScene, RandomGenerator, RandomScenes, clutter, finish_picture};
use poecal_detect::{BoardLayout, DetectedBoard, Detector, Gray, RejectionReason, png};
use rayon::prelude::*;

const BOARDS: [(&str, &str); 12] = [
    ("charuco", "charuco:7x5:36.195mm:18.256mm:DICT_6X6_250"),
    ("charuco-24mm", "charuco:11x8:24mm:18mm:DICT_5X5_250"),
    ("charuco-legacy", "charuco:7x6:30mm:22mm:DICT_4X4_50:legacy"),
    ("chessboard", "chessboard:10x7:28mm"),
    ("chessboard-even", "chessboard:8x6:30mm"),
    ("charuco-close", "charuco:7x5:36.195mm:28mm:DICT_4X4_50"),
    ("circles", "circles:9x6:30mm"),
    ("circles-odd", "circles:7x10:30mm"),
    ("circles-asymmetric", "circles:4x11:20mm:asymmetric"),
    ("tags-36h11", "tags:36h11:50mm"),
    ("tags-6x6", "tags:DICT_6X6_250:50mm"),
    ("aprilgrid", "aprilgrid:6x6:88mm:0.3"),
];

/// Boards that are searched for in pictures without them.
const SOUGHT: [&str; 7] = [
    "charuco:7x5:36.195mm:18.256mm:DICT_6X6_250",
    "chessboard:10x7:28mm",
    "circles:9x6:30mm",
    "circles:4x11:20mm:asymmetric",
    "tags:36h11:50mm",
    "tags:DICT_4X4_50:50mm",
    "aprilgrid:6x6:88mm:0.3",
];

/// Boards other than the sought one.
const OTHERS: [&str; 10] = [
    "charuco:7x5:36mm:18mm:DICT_5X5_250",
    "charuco:11x8:24mm:18mm:DICT_6X6_250",
    "charuco:5x7:36.195mm:18.256mm:DICT_6X6_250",
    "chessboard:12x9:24mm",
    "chessboard:9x7:28mm",
    "charuco:10x7:28mm:20mm:DICT_7X7_250",
    "circles:10x7:30mm",
    "circles:8x6:30mm",
    "circles:5x9:20mm:asymmetric",
    "tags:25h9:50mm",
];

#[derive(Default)]
struct RenderTally {
    visible: usize,
    found: usize,
    none: usize,
    far: usize,
    squares: f64,
    corners: usize,
    errors: Vec<f64>,
    within: usize,
    whitened: f64,
    by_tilt: [(f64, usize); 3],
    cpu_s: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let pictures: usize = arguments.next().map_or(Ok(40), |it| it.parse())?;
    let folder = arguments.next().filter(|it| it != "-");
    // One of the boards, to examine it alone; `none` for pictures without them.
    let only = arguments.next();
    let mut out = io::stdout();
    writeln!(
        out,
        "| board | found of visible | no board | RMS px | median | <30°, 30-45, >45 | beyond 1 px | within one sigma | error by sigma | ms of a processor |"
    )?;
    writeln!(out, "|---|---|---|---|---|---|---|---|---|---|")?;
    for (name, spec) in BOARDS {
        if only.as_ref().is_some_and(|it| it != name) {
            continue;
        }
        let detector = Detector::new(&spec.parse()?);
        let drawn: Vec<(usize, DrawnScene)> = (0..pictures)
            .into_par_iter()
            .map(|number| (number, draw(name).scene(detector.layout(), 2026, number)))
            .collect();
        if let Some(folder) = &folder {
            keep(&Path::new(folder).join(name), &drawn)?;
        }
        let tally = tally(&detector, &drawn);
        print(&mut out, name, pictures, tally)?;
    }
    if only.as_ref().is_none_or(|it| it.starts_with("none")) {
        // Boards of one kind: `none-circles`.
        let kind = only.as_deref().and_then(|it| it.strip_prefix("none-")).unwrap_or_default();
        false_corners(&mut out, pictures * 25, kind)?;
    }
    Ok(())
}

/// Scenes of a board: a pitch of an asymmetric grid is shorter than the distance between its dots.
fn draw(name: &str) -> RandomScenes {
    let square_px = match name {
        "circles-asymmetric" => [28.0, 78.0],
        _ => RandomScenes::default().square_px,
    };
    RandomScenes { square_px, ..RandomScenes::default() }
}

fn tally(detector: &Detector, drawn: &[(usize, DrawnScene)]) -> RenderTally {
    let mut tally = RenderTally::default();
    for (number, it) in drawn {
        let start = ThreadTime::now();
        let found = detector.detect(&it.picture);
        tally.cpu_s += start.elapsed().as_secs_f64();
        let visible = it.truth.iter().filter(|it| it.visible).count();
        tally.visible += visible;
        let seen = match found {
            Ok(found) => tally.add(*number, &found, it),
            Err(reason) => {
                eprintln!("picture {number}: {reason}");
                tally.none += 1;
                0
            }
        };
        if seen + 2 < visible {
            let (scene, tilt) = (&it.scene, it.tilt_deg);
            let contrast = scene.levels[1] - scene.levels[0];
            let (blur, noise) = (scene.blur_px, scene.noise);
            eprintln!(
                "picture {number}: {seen} of {visible}: tilt {tilt:.0}°, blur {blur:.2} px, noise {noise:.1} of {contrast:.0}"
            );
        }
    }
    tally
}

impl RenderTally {
    /// Adds the corners of a picture; returns the number of detected visible ones.
    fn add(&mut self, number: usize, found: &DetectedBoard, drawn: &DrawnScene) -> usize {
        let last = drawn.truth.len() - 1;
        let turn = is_turned(found, drawn);
        let mut seen = 0;
        for corner in &found.corners {
            let truth = &drawn.truth[if turn { last - corner.id } else { corner.id }];
            let off = Vector2::new(corner.u_px, corner.v_px) - truth.place_px;
            let error = off.norm();
            if error > 1.0 {
                let (id, sigma, visible) = (corner.id, corner.sigma_px, truth.visible);
                eprintln!("picture {number}: corner {id} off by {error:.2} px, sigma {sigma:.2}, visible: {visible}");
                self.far += 1;
                continue;
            }
            seen += usize::from(truth.visible);
            self.squares += error * error;
            self.corners += 1;
            self.errors.push(error);
            self.within += off.iter().filter(|it| it.abs() < corner.sigma_px).count();
            self.whitened += (off / corner.sigma_px).norm_squared();
            let bin = usize::from(drawn.tilt_deg >= 30.0) + usize::from(drawn.tilt_deg >= 45.0);
            self.by_tilt[bin].0 += error * error;
            self.by_tilt[bin].1 += 1;
        }
        self.found += seen;
        seen
    }
}

/// True if corners count from the other end, for a board that looks the same from both.
fn is_turned(found: &DetectedBoard, drawn: &DrawnScene) -> bool {
    let last = drawn.truth.len() - 1;
    let off = |turn: bool| {
        let place = |id: usize| drawn.truth[if turn { last - id } else { id }].place_px;
        found.corners.iter().map(|it| (Vector2::new(it.u_px, it.v_px) - place(it.id)).norm()).sum::<f64>()
    };
    found.turnable && off(true) < off(false)
}

fn print(out: &mut impl Write, name: &str, pictures: usize, mut tally: RenderTally) -> io::Result<()> {
    let root = |(squares, count): (f64, usize)| (squares / count.max(1) as f64).sqrt();
    tally.errors.sort_by(f64::total_cmp);
    let median = tally.errors.get(tally.errors.len() / 2).copied().unwrap_or(0.0);
    let [low, middle, high] = tally.by_tilt.map(root);
    writeln!(
        out,
        "| {name} | {:.1} % of {} | {} of {pictures} | {:.4} | {median:.3} | {low:.3} {middle:.3} {high:.3} | {} | {:.1} % | {:.2} | {:.0} |",
        100.0 * tally.found as f64 / tally.visible as f64,
        tally.visible,
        tally.none,
        root((tally.squares, tally.corners)),
        tally.far,
        100.0 * tally.within as f64 / (2 * tally.corners).max(1) as f64,
        (tally.whitened / (2 * tally.corners).max(1) as f64).sqrt(),
        1e3 * tally.cpu_s / pictures as f64,
    )
}

/// Pictures without the board, every fifth with another one.
fn false_corners(out: &mut impl Write, pictures: usize, kind: &str) -> Result<(), Box<dyn std::error::Error>> {
    let sought: Vec<&str> = SOUGHT.into_iter().filter(|it| it.starts_with(kind)).collect();
    let detectors: Vec<Detector> =
        sought.iter().map(|spec| Ok(Detector::new(&spec.parse()?))).collect::<Result<_, poecal_detect::Error>>()?;
    let others: Vec<BoardLayout> =
        OTHERS.iter().map(|spec| Ok(BoardLayout::new(&spec.parse()?))).collect::<Result<_, poecal_detect::Error>>()?;
    let picture = |number: usize| -> (Gray, Option<&str>) {
        if number % 5 == 4 {
            let other = number / 5 % others.len();
            return (RandomScenes::default().scene(&others[other], 7, number).picture, Some(OTHERS[other]));
        }
        let mut random = RandomGenerator::new(number as u64);
        let background = clutter([1920, 1200], &mut random);
        let (blur_px, noise) = (random.draw_uniform(0.5, 1.6), random.draw_uniform(1.0, 6.0));
        (finish_picture(background, blur_px, noise, &mut random), None)
    };
    let found: Vec<(usize, usize, Option<&str>, usize)> = (0..pictures)
        .into_par_iter()
        .flat_map_iter(|number| {
            let (gray, other) = picture(number);
            let all = detectors.iter().enumerate().map(move |(which, detector)| {
                let found: Result<_, RejectionReason> = detector.detect(&gray);
                (number, which, other, found.map_or(0, |it| it.corners.len()))
            });
            all.collect::<Vec<_>>()
        })
        .collect();
    for (number, which, other, corners) in found.iter().filter(|it| it.3 > 0) {
        eprintln!("picture {number}: detector {which} has {corners} corners on {other:?}");
    }
    writeln!(out, "{pictures} pictures without the board, a fifth with another one: corners in")?;
    for (which, spec) in sought.iter().enumerate() {
        let count = found.iter().filter(|it| it.1 == which && it.3 > 0).count();
        writeln!(out, "- {count} of {spec}")?;
    }
    Ok(())
}

/// Pictures as PNG, truth as CSV.
fn keep(folder: &Path, drawn: &[(usize, DrawnScene)]) -> Result<(), Box<dyn std::error::Error>> {
    fs::create_dir_all(folder)?;
    let mut truth = fs::File::create(folder.join("truth.csv"))?;
    writeln!(truth, "picture,id,u,v,visible,tilt")?;
    for (number, it) in drawn {
        let gray = &it.picture;
        let path = folder.join(format!("{number}.png"));
        fs::write(path, png(gray)?)?;
        for corner in &it.truth {
            let (place, visible) = (corner.place_px, u8::from(corner.visible));
            writeln!(truth, "{number},{},{:.5},{:.5},{visible},{:.1}", corner.id, place.x, place.y, it.tilt_deg)?;
        }
    }
    Ok(())
}
