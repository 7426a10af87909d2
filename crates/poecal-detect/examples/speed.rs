//! Times the detection of a board in pictures, decoding apart: `speed BOARD ROUNDS PICTURE...`. It prints milliseconds of one processor per picture
//! (the mean over pictures of the least of some rounds), the number of pictures with corners, the number of corners, and a number that changes with
//! any bit of them.

#![allow(clippy::print_stdout)]

use std::hash::{DefaultHasher, Hash, Hasher};

use cpu_time::ThreadTime;
use poecal_detect::{Detector, Gray, GrayPicture};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "expected BOARD ROUNDS PICTURE...";
    let detector = Detector::new(&arguments.next().ok_or(usage)?.parse()?);
    let rounds: usize = arguments.next().ok_or(usage)?.parse()?;
    let read = |path: String| Ok(GrayPicture::open(path.as_ref())?.gray);
    let pictures: Vec<Gray> = arguments.map(read).collect::<Result<_, poecal_detect::Error>>()?;
    let (mut least_s, mut found, mut corners, mut hasher) = (0.0, 0, 0, DefaultHasher::new());
    for gray in &pictures {
        let mut own_s = f64::INFINITY;
        for round in 0..rounds.max(1) {
            let start = ThreadTime::now();
            let detected = detector.detect(gray);
            own_s = own_s.min(start.elapsed().as_secs_f64());
            let Some(board) = detected.ok().filter(|_| round == 0) else { continue };
            found += 1;
            corners += board.corners.len();
            for it in board.corners {
                (it.id, it.u_px.to_bits(), it.v_px.to_bits(), it.sigma_px.to_bits()).hash(&mut hasher);
            }
        }
        least_s += own_s;
    }
    let (count, per_picture_ms) = (pictures.len(), 1e3 * least_s / pictures.len().max(1) as f64);
    println!("{per_picture_ms:.2} ms, {found} of {count} pictures, {corners} corners, {:016x}", hasher.finish());
    Ok(())
}
