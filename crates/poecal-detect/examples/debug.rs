//! x
use poecal_detect::*;
#[allow(clippy::all)]
fn main(){ let a:Vec<String>=std::env::args().collect(); let p=Picture::open(a[2].as_ref()).unwrap(); let d=Detector::new(&a[1].parse().unwrap()); let t=std::time::Instant::now(); let r=d.detect(&p.gray); println!("{:?} {:?}",t.elapsed(), r.map(|f|f.corners.len())); }
