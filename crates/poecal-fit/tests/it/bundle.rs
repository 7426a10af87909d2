//! Bundles of pictures: their derivatives compared with differences, and the shared error of corners compared with whitened poses.

use nalgebra::DVector;
use poecal_fit::parameters::{DeviceFrame, Parameter, TargetFrame, screw_axes};
use poecal_fit::problem::{Bundle, Problem};
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain, Session};
use poecal_model::camera::{Centre, CommonError, Distortion, Lens, PictureUnknown, PictureUnknowns};
use poecal_model::measurement::Noise;
use poecal_model::simulate::{PictureSimulation, SimulatedPictures, Simulation, elbow};
use poecal_numerics::solve::LeastSquares as _;

fn photograph_robot(in_hand: bool, noise_px: f64) -> SimulatedPictures {
    let session = Simulation { count: 10, error_rotation_rad: 2e-3, error_position_m: 1e-3, ..Simulation::default() };
    let usual = PictureSimulation::with_usual_camera(session, in_hand);
    let distortion = Distortion::Brown([-0.1, 0.02, 1e-4, 1e-4, 0.0, 0.0, 0.0, 0.0]);
    let lens = Lens { distortion, ..usual.lens };
    let mut made = PictureSimulation { lens, noise_px, ..usual }.run(&elbow()).unwrap();
    made.data.pictures.sigma_px = 0.3;
    made.data.pictures.all.iter_mut().for_each(|picture| picture.of_camera = in_hand);
    made
}

/// Nominal axes, with camera and board at their poses.
fn start(made: &SimulatedPictures) -> Estimate {
    let held = made.nominal.home * made.tip_from_held;
    Estimate::new(&made.nominal, vec![held], made.base_from_other.inverse())
}

fn numbers(session: Session<'_>, unknowns: &[PictureUnknown]) -> PictureUnknowns {
    let pictures = &session.data.pictures;
    PictureUnknowns::new(&pictures.cameras, &pictures.boards, unknowns)
}

fn bundle<'a>(session: Session<'a>, start: &Estimate, unknowns: &[PictureUnknown], common: CommonError) -> Bundle<'a> {
    let frames = [
        Parameter::DeviceFrame(DeviceFrame::new(0, start.device_from_base.translation)),
        Parameter::TargetFrame(TargetFrame::new(0)),
    ];
    let free = frames.into_iter().chain(screw_axes(start.kinds())).collect();
    Bundle::new(session, &session.data.all_rows(), free, numbers(session, unknowns)).unwrap().with_common(common)
}

const ALL: [PictureUnknown; 3] = [PictureUnknown::Lens(0), PictureUnknown::Board(0), PictureUnknown::Markers(0)];

#[test]
fn the_gradient_is_that_of_differences() {
    let mut worst: f64 = 0.0;
    for in_hand in [true, false] {
        let made = photograph_robot(in_hand, 0.3);
        let packed = PackedValues::from_dataset(&made.nominal, &made.data);
        let session = Session::new(&made.nominal, &made.data, &packed, true);
        let start = start(&made);
        let bundle = bundle(session, &start, &ALL, CommonError::NONE);
        let robot = bundle.layout().dim();
        let numbers = DVector::from_fn(self::numbers(session, &ALL).count(), |k, _| 0.1 * (k as f64).sin());
        let sums = bundle.normal(&start, &numbers);
        let corners = made.data.pictures.all.iter().flat_map(|it| &it.corners);
        let seen = corners.filter(|corner| corner.weight > 0.0).count();
        assert_eq!(sums.residuals, 2 * seen + numbers.len());
        let scale = sums.gradient.iter().fold(0.0, |most: f64, it| most.max(it.abs()));
        for k in 0..sums.gradient.len() {
            let at = |h: f64| {
                let (mut step, mut next) = (vec![0.0; robot], numbers.clone());
                if k < robot {
                    step[k] = h
                } else {
                    next[k - robot] += h
                }
                bundle.normal(&bundle.layout().retract(&start, &step), &next).cost
            };
            let h = if k < robot { 1e-6 } else { 1e-4 };
            let slope = -(at(h) - at(-h)) / (2.0 * h);
            let own = (sums.gram[k * (sums.gradient.len() + 1)] * 2.0 * sums.cost).sqrt();
            worst = worst.max((slope - sums.gradient[k]).abs() / own.max(1e-9 * scale));
        }
    }
    println!("gradients differ by {worst:.1e} of the largest that these residuals allow");
    // Central differences: half of the digits of the cost by the step.
    assert!(worst < 1e-5, "{worst:e}");
}

/// The shared error of corners, eliminated, has the result of poses whitened with the same error.
#[test]
fn what_corners_share_is_eliminated() {
    let mut worst: f64 = 0.0;
    for (in_hand, about) in [(true, Centre::Board), (true, Centre::Camera), (false, Centre::Camera)] {
        let made = photograph_robot(in_hand, 0.3);
        let packed = PackedValues::from_dataset(&made.nominal, &made.data);
        let session = Session::new(&made.nominal, &made.data, &packed, true);
        let start = start(&made);
        let common = CommonError { shift_m: 1e-3, turn_rad: 2e-3, about, corners: 1.0 };
        let numbers = DVector::zeros(8);
        let lens = [PictureUnknown::Lens(0)];
        let of = |common| bundle(session, &start, &lens, common).normal(&start, &numbers);
        let (with, without) = (of(common), of(CommonError::NONE));
        let n = with.gradient.len();
        // The rows of the session, whitened with the same error, have the robot's part.
        let mut data = made.data.clone();
        data.pictures.common = common;
        let (linkage, mut chain) = (Linkage::new(&start), RowChain::default());
        for at in 0..data.pictures.all.len() {
            let picture = &data.pictures.all[at];
            let row = picture.row as usize;
            chain.evaluate(&linkage, &packed, row, &data.observations[row]);
            let pose = picture.directed_measurement(&chain.target);
            let view = data.pictures.view(picture).unwrap();
            let mut sighting = view.sighting_near(&pose).unwrap();
            sighting.camera_from_board = pose;
            sighting.information = view.information(&pose);
            data.state_picture(at, &sighting);
        }
        let session = Session { data: &data, ..session };
        let free = bundle(session, &start, &lens, common).layout().parameters().map(|it| *it.0).collect();
        let problem = Problem::new(session, data.all_rows(), free, Noise::new(1.0, 1.0));
        let normal = problem.normal(&start);
        let robot = problem.layout().dim();
        for i in 0..robot {
            for k in i..robot {
                let size = (with.gram[i * n + i] * with.gram[k * n + k]).sqrt();
                worst = worst.max((with.gram[i * n + k] - normal.gram[i * robot + k]).abs() / size);
            }
        }
        assert!((0..n).all(|k| with.gram[k * n + k] <= without.gram[k * n + k]));
        assert!(with.cost < without.cost);
    }
    println!("information of the robot's unknowns: {worst:.1e} beside that of whitened poses");
    // The tolerance is for the root of a matrix and back.
    assert!(worst < 1e-6, "{worst:e}");
}

#[test]
fn a_bundle_finds_the_lens() {
    let made = photograph_robot(true, 0.01);
    let packed = PackedValues::from_dataset(&made.nominal, &made.data);
    let mut data = made.data.clone();
    let truth = data.pictures.cameras[0].lens;
    data.pictures.cameras[0].lens.focal_px = [1510.0, 1490.0];
    let session = Session::new(&made.nominal, &data, &packed, true);
    let start = start(&made);
    let lens = [PictureUnknown::Lens(0)];
    let numbers = numbers(session, &lens);
    let found = bundle(session, &start, &lens, CommonError::NONE).solve(&start, &DVector::zeros(numbers.count()));
    let (cameras, _) = numbers.apply_step(&found.numbers);
    let off = (cameras[0].lens.focal_px[0] - truth.focal_px[0]).abs();
    println!("cost {:.3}, {} passes, focal length off by {off:.3} px", found.cost, found.passes);
    // 480 numbers with noise of 0.01 px come to 0.27, the prior of the focal lengths, a third of a deviation away, to 0.06.
    assert!(found.cost < 0.5 && off < 0.2, "{} {off}", found.cost);
}
