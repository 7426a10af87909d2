//! Compares corners in real pictures with those that are known: `POECAL_DATASETS=FOLDER real`.
use poecal_detect::*;
use std::collections::*;
#[allow(clippy::all)]
fn main() {
    let base = std::env::var("POECAL_DATASETS").unwrap();
    let mut known: BTreeMap<String, BTreeMap<usize, [f64; 2]>> = BTreeMap::new();
    let dir = format!("{base}/handeye_images/charuco_static_camera");
    for line in std::fs::read_to_string(format!("{dir}/corners.csv")).unwrap().lines().skip(1) {
        let f: Vec<&str> = line.split(',').collect();
        known
            .entry(f[0].to_owned())
            .or_default()
            .insert(f[1].parse().unwrap(), [f[5].parse().unwrap(), f[6].parse().unwrap()]);
    }
    let d = Detector::new(&"charuco:5x7:36.195mm:18.256mm:DICT_6X6_250".parse().unwrap());
    let (mut common, mut total, mut mine, mut sq, mut sqr) = (0, 0, 0, 0.0, 0.0);
    let mut e = vec![];
    for k in 0..16 {
        let name = format!("{k}.jpg");
        let p = Picture::open(format!("{dir}/images_gray_jpeg/{name}").as_ref());
        let Ok(p) = p else {
            println!("{k} {p:?}");
            continue;
        };
        let t = std::time::Instant::now();
        let r = d.detect(&p.gray);
        let none = BTreeMap::new();
        let own = known.get(&name).unwrap_or(&none);
        total += own.len();
        match r {
            Ok(f) => {
                mine += f.corners.len();
                for c in &f.corners {
                    eprintln!("charuco/{k} {} {} {} {}", c.id, c.u_px, c.v_px, c.sigma_px);
                }
                let mut c = 0;
                let mut s = 0.0;
                let mut miss = own.keys().copied().collect::<BTreeSet<_>>();
                let mut worst: Vec<String> = vec![];
                for x in &f.corners {
                    miss.remove(&x.id);
                    if let Some(o) = own.get(&x.id) {
                        c += 1;
                        let q = (o[0] - x.u_px).hypot(o[1] - x.v_px);
                        s += q * q;
                        e.push(q);
                        sqr += x.sigma_px;
                        if q > 0.3 {
                            worst.push(format!("{}:{q:.2}", x.id));
                        }
                    }
                }
                common += c;
                sq += s;
                println!(
                    "{k}: {} corners, {} of OpenCV's {}, rms {:.3} blur {:.2} noise {:.1} markers {} sigma {:.3} miss {miss:?} far {worst:?} {:?}",
                    f.corners.len(),
                    c,
                    own.len(),
                    (s / c as f64).sqrt(),
                    f.blur_px,
                    f.noise,
                    f.markers,
                    f.corners.iter().map(|c| c.sigma_px).sum::<f64>() / f.corners.len() as f64,
                    t.elapsed()
                );
            }
            Err(r) => println!("{k}: {r}, OpenCV {}", own.len()),
        }
    }
    e.sort_by(f64::total_cmp);
    println!(
        "common {common} of {total}, mine {mine}, rms {:.3}, median {:.3} mean sigma {:.3}",
        (sq / common as f64).sqrt(),
        e[e.len() / 2],
        sqr / common as f64
    );
    for (set, folder, spec) in [
        ("ur10e_eye_in_hand", vec!["measurements-2023-02-07"], "chessboard:10x7:27mm"),
        ("ur3e_eye_in_hand", vec!["measurements_26_04", "measurements_26_04_1"], "chessboard:10x7:26.2mm"),
    ] {
        let d = Detector::new(&spec.parse().unwrap());
        let mut known: BTreeMap<(String, String), BTreeMap<usize, [f64; 4]>> = BTreeMap::new();
        for line in std::fs::read_to_string(format!("{base}/{set}/pixels.csv")).unwrap().lines().skip(1) {
            let f: Vec<&str> = line.split(',').collect();
            let id: usize = f[11].trim_start_matches("corner").parse().unwrap();
            known
                .entry((f[2].to_owned(), f[3].to_owned()))
                .or_default()
                .insert(id, [12, 13, 14, 15].map(|k| f[k].parse().unwrap_or(f64::NAN)));
        }
        for f in folder {
            let mut names: Vec<_> = std::fs::read_dir(format!("{base}/{set}/images/{f}"))
                .unwrap()
                .map(|e| e.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            let session = if set.starts_with("ur10e") { "ur10e".to_owned() } else { f.to_owned() };
            let (mut n, mut total, mut turned) = (0, 0, 0);
            let mut sq = [0.0, 0.0];
            for name in names {
                let p = Picture::open(format!("{base}/{set}/images/{f}/{name}").as_ref()).unwrap();
                let r = d.detect(&p.gray);
                let none = BTreeMap::new();
                let own = known.get(&(session.clone(), name.clone())).unwrap_or(&none);
                total += own.len();
                match r {
                    Ok(x) => {
                        for c in &x.corners {
                            eprintln!("{set}/{f}/{name} {} {} {} {}", c.id, c.u_px, c.v_px, c.sigma_px);
                        }
                        let off = |turn: bool, k: usize| {
                            x.corners
                                .iter()
                                .filter_map(|c| {
                                    let o = own.get(&if turn { 53 - c.id } else { c.id })?;
                                    Some((o[k] - c.u_px).powi(2) + (o[k + 1] - c.v_px).powi(2))
                                })
                                .sum::<f64>()
                        };
                        let turn = off(true, 0) < off(false, 0);
                        if own.len() > 0 {
                            turned += usize::from(turn);
                            n += x.corners.len();
                            sq[0] += off(turn, 0);
                            sq[1] += off(turn, 2);
                        }
                        println!(
                            "{set} {name}: {} corners, of {}, turned {turn}, rms {:.3} {:.3} blur {:.2} noise {:.2} sigma {:.3}",
                            x.corners.len(),
                            own.len(),
                            (off(turn, 0) / own.len() as f64).sqrt(),
                            (off(turn, 2) / own.len() as f64).sqrt(),
                            x.blur_px,
                            x.noise,
                            x.corners.iter().map(|c| c.sigma_px).sum::<f64>() / x.corners.len() as f64
                        );
                    }
                    Err(r) => println!("{set} {name}: {r} of {}", own.len()),
                }
            }
            println!(
                "{set} {f}: {n} of {total}, turned {turned}, rms {:.3} {:.3}",
                (sq[0] / n as f64).sqrt(),
                (sq[1] / n as f64).sqrt()
            );
        }
    }
}
