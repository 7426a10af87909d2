//! x
use poecal_detect::{*,render::*};
#[allow(clippy::all)]
fn main(){ let n:u64=std::env::args().nth(1).unwrap().parse().unwrap(); let mut random = Random::new(n); let b = clutter([1920, 1200], &mut random); let (bl,no)=(random.uniform(0.5, 1.6), random.uniform(1.0, 6.0)); let g=finished(b,bl,no,&mut random); image::save_buffer("/tmp/dl/x.png", &g.bytes(), 1920,1200, image::ExtendedColorType::L8).unwrap(); let d=Detector::new(&"chessboard:10x7:28mm".parse().unwrap()); println!("{:?}", d.detect(&g)); }
