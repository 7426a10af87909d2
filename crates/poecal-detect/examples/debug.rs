//! x
use poecal_detect::*;
#[allow(clippy::all)]
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let p = Picture::open(a[2].as_ref()).unwrap();
    let d = Detector::new(&a[1].parse().unwrap());
    let t = std::time::Instant::now();
    let r = d.detect(&p.gray);
    let e = t.elapsed();
    match r {
        Ok(f) => {
            println!("{e:?} {} {}", f.corners.len(), f.markers);
            for c in f.corners {
                println!("{} {:.4} {:.4} {:.4}", c.id, c.u_px, c.v_px, c.sigma_px);
            }
        }
        Err(x) => {
            println!("{e:?} {x}");
            if let Some(s) = d.suggest(&[&p.gray]) {
                println!("suggestion {s} {:?}", t.elapsed());
            }
        }
    }
}
