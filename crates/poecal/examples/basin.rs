//! scratch
use poecal::calibration::*;
use poecal::simulate::*;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
fn main() {
    let trials: u64 = std::env::args().nth(1).map_or(200, |a| a.parse().unwrap());
    for (kind, name) in [(Kind::Pose, "pose"), (Kind::Point, "point")] {
        for (deg, mm) in [(3.0f64, 15.0), (10.0, 50.0), (20.0, 100.0), (40.0, 200.0)] {
            let mut ok = 0;
            let mut restarted = 0;
            let mut rescued = 0;
            let mut its = 0;
            let t = std::time::Instant::now();
            for seed in 0..trials {
                let s = Simulation {
                    error_rotation_rad: deg.to_radians(),
                    error_position_m: mm / 1e3,
                    noise_position_m: 5e-5,
                    noise_rotation_rad: 1e-4,
                    count: 60,
                    seed,
                    device_anywhere: false,
                };
                // start = elbow perturbed, truth = elbow
                let mut g = ChaCha8Rng::seed_from_u64(seed);
                let start = s.perturbed(&elbow(), &mut g);
                let made = s.measure(&elbow(), elbow(), kind, &mut g).unwrap();
                let base = std::env::args().nth(2).is_none();
                let c = calibrate(
                    &start,
                    &made.data,
                    &CalibrationOptions {
                        frame: if base { DeviceFrameKnowledge::Base } else { DeviceFrameKnowledge::Unknown },
                        held_out: 0.0,
                        ..Default::default()
                    },
                );
                let Ok(c) = c else { continue };
                let good = c.accuracy.training.calibrated.position_mm.rms < 0.2;
                if !good {
                    println!(
                        "  seed {seed} rms {:.2} registered {:.2} {:?}",
                        c.accuracy.training.calibrated.position_mm.rms,
                        c.accuracy.training.registered.position_mm.rms,
                        c.solver.termination
                    );
                }
                ok += good as u32;
                restarted += (c.solver.restarts > 0) as u32;
                rescued += (c.solver.restarts > 0 && good) as u32;
                its += c.solver.iterations;
            }
            println!(
                "{name} {deg}deg {mm}mm: {ok}/{trials} restarted {restarted} rescued {rescued} mean its {} time/fit {:?}",
                its as f64 / trials as f64,
                t.elapsed() / trials as u32
            );
        }
    }
}
