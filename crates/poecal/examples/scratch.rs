//! scratch
use poecal::calibration::*;
use poecal::simulate::*;
fn main() {
    for (name, kind, count) in [("poses", Kind::Pose, 43), ("points", Kind::Point, 143)] {
        let s = Simulation {
            noise_position_m: 0.0,
            noise_rotation_rad: 0.0,
            count,
            device_anywhere: false,
            ..Default::default()
        };
        let made = s.run(&elbow(), kind).unwrap();
        let c = calibrate(
            &made.nominal,
            &made.data,
            &CalibrationOptions { frame: DeviceFrameKnowledge::Base, ..Default::default() },
        )
        .unwrap();
        println!(
            "elbow {name}: it {} {:?} rank {}/{} held {:?}",
            c.solver.iterations,
            c.solver.termination,
            c.identifiability.rank,
            c.identifiability.parameters,
            c.accuracy.held_out.unwrap().calibrated.position_mm.max
        );
        println!("   {:?}", c.solver.trace.iter().map(|x| x.sqrt()).collect::<Vec<_>>());
    }
    let mut robots = vec![elbow(), scara(), gantry(), seven_axis()];
    for n in 2..=12 {
        for s in 0..3 {
            robots.push(random_chain(n, s));
        }
    }
    for r in &robots {
        for kind in [Kind::Pose, Kind::Point, Kind::Mixed] {
            let s = Simulation {
                noise_position_m: 0.0,
                noise_rotation_rad: 0.0,
                count: 150,
                device_anywhere: true,
                ..Default::default()
            };
            let made = s.run(r, kind).unwrap();
            let t = std::time::Instant::now();
            let c = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
            let t = t.elapsed();
            let h = c.accuracy.held_out.unwrap();
            println!(
                "{:12} {kind:?}: it {} {:?} restarts {} rank {}/{} cond {:.1e} reg {:.3} held {:.1e} mm  {:?} {}",
                r.name,
                c.solver.iterations,
                c.solver.termination,
                c.solver.restarts,
                c.identifiability.rank,
                c.identifiability.parameters,
                c.identifiability.condition,
                h.registered.position_mm.max,
                h.calibrated.position_mm.max,
                t,
                if h.calibrated.position_mm.max > 1e-6 { "<<<<" } else { "" }
            );
            for d in &c.identifiability.unidentifiable {
                println!("      {}", d.description);
            }
        }
    }
}
