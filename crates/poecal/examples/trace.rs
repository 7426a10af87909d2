//! scratch
use poecal::calibration::*;
use poecal::simulate::*;
fn main() {
    for noise in [0.0, 5e-5] {
        for any in [false, true] {
            let s = Simulation {
                noise_position_m: noise,
                noise_rotation_rad: 0.0,
                count: 150,
                device_anywhere: any,
                ..Default::default()
            };
            let made = s.run(&elbow(), Kind::Point).unwrap();
            let c = calibrate(
                &made.nominal,
                &made.data,
                &CalibrationOptions {
                    frame: if any { DeviceFrameKnowledge::Unknown } else { DeviceFrameKnowledge::Base },
                    ..Default::default()
                },
            )
            .unwrap();
            println!(
                "elbow noise {noise} any {any}: it {} {:?} rank {}/{} held {:?}",
                c.solver.iterations,
                c.solver.termination,
                c.identifiability.rank,
                c.identifiability.parameters,
                c.accuracy.held_out.unwrap().calibrated.position_mm.max
            );
            println!("   {:?}", c.solver.trace.iter().map(|x| x.sqrt()).collect::<Vec<_>>());
        }
    }
}
