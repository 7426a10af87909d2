//! Pictures: lenses and poses beside OpenCV, and arms calibrated from corners.

use nalgebra::{Vector2, Vector3};
use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::CalibrationOptions;
use poecal_calibrate::calibrate;
use poecal_fit::start::settle_pictures;
use poecal_model::camera::{Board, CommonError, Corner, Distortion, Lens, SightingInput, poses_of_rays};
use poecal_model::simulate::{PictureSimulation, Simulation, elbow};

use poecal_testing::trials::trials;

fn lens(k: [f64; 8]) -> Lens {
    Lens { distortion: Distortion::Brown(k), ..Lens::pinhole([1510.0, 1490.0], [960.0, 610.0]) }
}

/// `cv2.projectPoints` and `cv2.fisheye.projectPoints` of OpenCV 4.14 for three points.
#[test]
fn lenses_are_those_of_opencv() {
    let points = [[0.1, -0.2, 1.0], [0.4, 0.3, 0.9], [-0.3, 0.1, 2.0]];
    let fisheye = Lens { distortion: Distortion::Fisheye([-0.02, 0.01, -0.004, 0.0005]), ..lens([0.0; 8]) };
    let cases = [
        (lens([0.0; 8]), [1111.0, 312.0, 1631.1111111111113, 1106.6666666666665, 733.5, 684.5]),
        (
            lens([-0.18, 0.04, 1e-3, -7e-4, -0.01, 0.0, 0.0, 0.0]),
            [
                1109.52152125,
                314.88799249999994,
                1595.8906366650087,
                1081.3024948231944,
                734.416982890625,
                684.2269458593751,
            ],
        ),
        (
            lens([0.4, 0.1, 4e-4, 2e-4, 0.02, 0.5, 0.15, 0.01]),
            [
                1110.2424411173215,
                313.5546499803852,
                1611.2165045572083,
                1092.0583094289682,
                734.0782425364685,
                684.327188768358,
            ],
        ),
        (
            fisheye,
            [
                1108.4158632433785,
                317.0998195594252,
                1569.789276371332,
                1061.2844479105718,
                735.4688216270877,
                683.8524184935186,
            ],
        ),
    ];
    let mut worst: f64 = 0.0;
    for (lens, expected) in cases {
        for (point, pixel) in points.iter().zip(expected.chunks_exact(2)) {
            let found = lens.pixel(&Vector3::from(*point)).unwrap();
            worst = worst.max((found - Vector2::new(pixel[0], pixel[1])).norm());
        }
    }
    println!("pixels apart from OpenCV's: {worst:.1e}");
    // Rounding of numbers of 1,000.
    assert!(worst < 1e-9, "{worst:e}");
}

/// A board as OpenCV saw it, and the poses that it returns: rotation vector, translation, root mean square distance in pixels.
struct Seen {
    pixels: [[f64; 2]; 24],
    poses: [([f64; 3], [f64; 3], f64); 2],
}

/// Both solutions of `cv2.solvePnPGeneric(…, SOLVEPNP_IPPE)`, each refined by `solvePnPRefineLM`, of OpenCV 4.14.
#[test]
fn a_flat_board_has_both_poses_of_opencv() {
    let lens = lens([-0.18, 0.04, 1e-3, -7e-4, -0.01, 0.0, 0.0, 0.0]);
    let board = Board::chessboard("board", [5, 7], 0.036).unwrap();
    let (mut turned, mut shifted): (f64, f64) = (0.0, 0.0);
    for Seen { pixels, poses } in seen_boards() {
        let corner = |(point, pixel): (u32, &[f64; 2])| Corner {
            point,
            pixel: Vector2::from(*pixel),
            sigma_px: None,
            weight: 1.0,
            line: 0,
        };
        let corners: Vec<Corner> = (0..).zip(&pixels).map(corner).collect();
        let view = SightingInput { lens: &lens, board: &board, corners: &corners, sigma_px: 0.3 };
        let mut found: Vec<(f64, Pose)> = poses_of_rays(&view.rays())
            .iter()
            .filter_map(|start| view.sighting(start, false))
            .map(|it| ((it.cost_px2 / 24.0).sqrt(), it.camera_from_board))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(found.len(), 2, "{found:?}");
        for ((rms, pose), (turn, shift, expected)) in found.iter().zip(poses) {
            let reference = Pose::new(rotation::exp(&Vector3::from(turn)), Vector3::from(shift));
            let (metres, radians) = pose.distance_and_angle(&reference);
            println!("{rms:.4} px, {expected:.4} by OpenCV: {:.1e} m and {radians:.1e} rad apart", metres);
            (turned, shifted) = (turned.max(radians), shifted.max(metres));
            assert!((rms - expected).abs() < 1e-4);
        }
    }
    // Pixels are stated to 1e-4, which is 4e-5 of their noise; a minimum is as flat as that.
    assert!(turned < 2e-5 && shifted < 2e-5, "{turned:e} rad, {shifted:e} m");
}

fn seen_boards() -> [Seen; 3] {
    [
        Seen {
            pixels: [
                [775.0737, 519.0624],
                [800.7943, 542.1325],
                [827.7636, 567.2229],
                [855.3254, 592.7763],
                [751.4547, 557.9382],
                [776.8624, 581.9429],
                [802.6419, 607.3774],
                [829.5720, 632.8906],
                [728.7360, 595.8101],
                [752.4787, 620.5379],
                [778.3484, 646.1625],
                [804.5163, 673.2779],
                [706.3315, 633.6192],
                [729.6799, 659.1106],
                [754.9262, 685.1807],
                [780.6933, 712.8679],
                [683.8517, 670.5654],
                [707.2753, 696.6932],
                [731.6970, 723.0126],
                [756.3458, 750.9329],
                [661.6608, 707.3896],
                [685.0274, 733.4107],
                [708.8841, 761.1274],
                [733.2071, 789.2539],
            ],
            poses: [
                ([0.01711690, 0.68002895, 0.61233490], [-0.14128514, -0.07049526, 1.14911118], 0.354650),
                ([-0.15256688, -0.91659840, 0.63473576], [-0.13808407, -0.07139769, 1.13907285], 4.244757),
            ],
        },
        Seen {
            pixels: [
                [827.2741, 414.0377],
                [894.7590, 430.6116],
                [957.9656, 446.1504],
                [1016.7790, 461.2198],
                [793.9341, 488.7354],
                [861.6758, 503.0058],
                [924.4052, 516.0934],
                [983.8040, 528.7196],
                [761.0829, 561.7747],
                [829.1520, 572.7203],
                [891.8400, 583.6599],
                [950.8565, 593.3281],
                [731.0617, 631.0852],
                [797.8126, 639.9116],
                [861.0169, 648.9251],
                [920.6688, 655.5711],
                [700.9640, 699.2136],
                [768.5068, 705.5648],
                [830.6578, 711.5054],
                [889.9246, 716.9112],
                [672.7193, 763.9142],
                [739.4926, 768.0969],
                [801.8959, 771.7065],
                [860.7054, 776.0951],
            ],
            poses: [
                ([0.47822072, -0.66520805, 0.30721620], [-0.05477868, -0.08212558, 0.62081815], 0.387114),
                ([-0.47065977, 0.50209205, 0.27549767], [-0.06630729, -0.08752776, 0.75526423], 11.506159),
            ],
        },
        Seen {
            pixels: [
                [750.3281, 725.8536],
                [786.4641, 757.5447],
                [819.9902, 785.7471],
                [853.2071, 813.5982],
                [717.6077, 772.3939],
                [754.3841, 802.6016],
                [789.4912, 831.0050],
                [823.0925, 858.0251],
                [683.7888, 819.0493],
                [722.3537, 848.3235],
                [758.4461, 876.3647],
                [793.3553, 902.8934],
                [651.0419, 867.1510],
                [689.2648, 895.1794],
                [726.4905, 921.9654],
                [762.1191, 947.9364],
                [616.7357, 915.4308],
                [655.8742, 942.8821],
                [694.6894, 969.3004],
                [731.4049, 993.6180],
                [582.0403, 965.0558],
                [623.3249, 991.4933],
                [662.9127, 1015.9008],
                [699.9616, 1040.2636],
            ],
            poses: [
                ([-0.09566849, -0.71876791, 0.66656841], [-0.13176517, 0.07402227, 0.94517876], 0.421068),
                ([-0.33932985, 0.50801706, 0.52692145], [-0.14243123, 0.08348971, 0.99936187], 5.148685),
            ],
        },
    ]
}

/// 60 configurations of an arm with errors of milliradians and millimetres.
pub(crate) fn session(seed: u64) -> Simulation {
    Simulation { count: 60, seed, error_rotation_rad: 3e-3, error_position_m: 1e-3, ..Simulation::default() }
}

/// Held-out figures of simulated sessions, 60 pictures each: the error of the tip in other configurations, and that predicted by the verdict.
fn judge_sessions(in_hand: bool, common: CommonError, seed: u64) -> (f64, f64, usize) {
    let session = session(seed);
    let simulated = PictureSimulation { common, ..PictureSimulation::with_usual_camera(session, in_hand) };
    let mut made = simulated.run(&elbow()).unwrap();
    let said = settle_pictures(&mut made.data, &made.nominal).notes;
    assert_eq!(said[0].contains("on the last link, and the board stays"), in_hand, "{said:?}");
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    let held_out = calibration.accuracy.held_out.unwrap();
    let before = held_out.registered.pixels.unwrap();
    let after = held_out.calibrated.pixels.unwrap();
    println!(
        "in hand {in_hand}, seed {seed}: {:.2} px before, {:.2} px after, {:.3} mm at the board; {}",
        before.rms_px,
        after.rms_px,
        after.rms_mm,
        calibration.verdict.level.words()
    );
    (after.rms_px, after.rms_mm, after.pictures)
}

#[test]
fn an_arm_is_calibrated_from_pictures_wherever_the_camera_is() {
    let still = CommonError { shift_m: 0.0, turn_rad: 0.0, ..CommonError::default() };
    for in_hand in [true, false] {
        for seed in 1..4 {
            let (px, mm, pictures) = judge_sessions(in_hand, still, seed);
            // Corners of 0.3 px for each coordinate have an error of 0.42 px by themselves.
            assert!(pictures == 18 && px < 0.55 && mm < 0.35, "{px} px, {mm} mm");
        }
    }
}

#[test]
fn the_error_of_the_configuration_is_found_and_weighs_pictures() {
    for (shift_m, turn_rad) in [(1e-4, 1e-4), (5e-4, 5e-4)] {
        let common = CommonError { shift_m, turn_rad, ..CommonError::default() };
        let (px, mm, _) = judge_sessions(true, common, 5);
        println!("{px:.2} px, {mm:.3} mm with {} mm and mrad a configuration", 1e3 * shift_m);
        // Beside the corners' own noise, the configuration's: shift and turn at 0.8 m, two directions of it.
        let own = 1e3 * (2.0 * (shift_m.powi(2) + (0.8 * turn_rad).powi(2))).sqrt();
        assert!(mm < 1.5 * own.hypot(0.25), "{mm} mm");
    }
}

/// Bounds of 95 % on pictures that were held out, with corners alone and with an additional error of each configuration.
#[test]
fn bounds_hold_on_pictures_that_were_not_fitted() {
    let sessions = trials(16);
    let part = 1.0 / sessions.count as f64;
    for millis in [0.0, 0.1, 0.5] {
        let common = CommonError { shift_m: 1e-3 * millis, turn_rad: 1e-3 * millis, ..CommonError::default() };
        let (mut inside, mut ratio) = ([0.0; 2], 0.0);
        for seed in sessions.seeds() {
            let session = session(100 + seed);
            let simulated =
                PictureSimulation { common, ..PictureSimulation::with_usual_camera(session, seed % 2 == 0) };
            let mut made = simulated.run(&elbow()).unwrap();
            settle_pictures(&mut made.data, &made.nominal);
            let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
            let kept = calibration.trust.held_out.unwrap();
            let rotation = kept.rotation_deg().unwrap();
            inside[0] += kept.position_mm().inside_bound95 * part;
            inside[1] += rotation.inside_bound95 * part;
            let error = calibration.accuracy.held_out.unwrap().calibrated.position_mm().rms;
            ratio += (error / kept.position_mm().expected_rms).ln() * part;
        }
        println!(
            "{millis} mm and mrad a configuration: {:.1} % of positions and {:.1} % of rotations inside, error over expected {:.2}",
            100.0 * inside[0],
            100.0 * inside[1],
            ratio.exp()
        );
        // 16 sessions of 18 pictures: 95 % ± 1.3 %, and the pictures of a session share its fit.
        let least = 0.89 - sessions.tolerance_factor(0.07);
        assert!(inside.iter().all(|it| (least..=1.0).contains(it)), "{inside:?}");
        assert!((0.7..1.3).contains(&ratio.exp()), "{}", ratio.exp());
    }
}
