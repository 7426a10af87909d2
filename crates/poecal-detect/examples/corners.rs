//! Prints the corners of a board in pictures as a table, or the reason for a rejection: `corners BOARD PICTURE...`. If no picture has corners, it
//! prints another board that fits.

#![allow(clippy::print_stdout)]

use poecal_detect::{Detector, Gray, GrayPicture};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let board = arguments.next().ok_or("expected BOARD PICTURE...")?;
    let detector = Detector::new(&board.parse()?);
    let mut without: Vec<Gray> = Vec::new();
    let mut pictures = 0;
    println!("picture,name,u[px],v[px],sigma[px]");
    for path in arguments {
        let picture = GrayPicture::open(path.as_ref())?;
        pictures += 1;
        if picture.turned.is_turned() {
            println!("# {path}: {}", picture.turned);
        }
        match detector.detect(&picture.gray) {
            Ok(found) => {
                for corner in found.corners {
                    let (u, v, sigma) = (corner.u_px, corner.v_px, corner.sigma_px);
                    println!("{path},{},{u:.4},{v:.4},{sigma:.4}", corner.name());
                }
            }
            Err(reason) => {
                println!("# {path}: {reason}");
                without.push(picture.gray);
            }
        }
    }
    if without.len() == pictures {
        let first: Vec<&Gray> = without.iter().take(3).collect();
        if let Some(suggestion) = detector.suggest(&first) {
            println!("# {suggestion}");
        }
    }
    Ok(())
}
