//! A visit: the rows of some measurements as linear functions of all possible changes, about the delivered model.

use nalgebra::{DMatrix, DVector, Vector3};

use super::model::VisitModel;
use super::options::TrackOptions;
use poecal_arm::lie::Pose;
use poecal_calibrate::whitened_rows;
use poecal_fit::parameters::{Parameter, ParameterSubject, ScrewAxis, TargetFrame, TargetPlace, ValueTerm};
use poecal_fit::problem::Problem;
use poecal_fit::start::{Registration, device_parameter, faces_on_known_planes, register, target_parameters};
use poecal_fit::state::{Estimate, InstrumentMount, Linkage, PackedValues, RowChain, Session, nominal_estimate};
use poecal_model::measurement::{Dataset, Quantity};
use poecal_model::robot::{Body, Robot, Term};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::linalg;

/// Subject of columns of a visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColumnSubject {
    /// Pose of the device at a station.
    Device(usize),
    /// Pose of a target on the arm.
    Target(usize),
    /// All lengths of the arm, as a share.
    Lengths,
    /// The zero of a joint, by its index in the delivered robot.
    Zero(usize),
    /// The axis of a joint.
    Axis(usize),
    /// Compliance of a joint.
    Give(usize),
}

/// Columns of one change.
#[derive(Clone, Debug)]
pub(crate) struct ChangeColumns {
    pub(crate) of: ColumnSubject,
    /// Indices of the columns in the Jacobian.
    pub(crate) places: Vec<usize>,
    /// For each unknown, true if it is an angle; otherwise it is a length or a share.
    pub(crate) turns: Vec<bool>,
}

/// The rows of a visit.
#[derive(Clone, Debug)]
pub(crate) struct Visit {
    /// First index of each row's numbers.
    pub(crate) starts: Vec<usize>,
    /// Derivatives of the measured numbers, metres or radians, by each unknown in its own unit.
    pub(crate) jacobian: DMatrix<f64>,
    /// Measured less predicted, metres or radians: positions along the axes of the base.
    pub(crate) residual: DVector<f64>,
    /// Standard deviation of each number.
    pub(crate) sigma: DVector<f64>,
    pub(crate) quantities: Vec<Quantity>,
    pub(crate) columns: Vec<ChangeColumns>,
    /// Derivatives by the unknowns of the calibration, transformed so that these are independent with variance 1; `None` without an uncertainty.
    pub(crate) by_known: Option<DMatrix<f64>>,
    /// Each target's pose with all joints at zero, base frame, and the motions of it that its columns are.
    pub(crate) targets: Vec<(Pose, &'static [usize])>,
    /// Frame of each axis with all joints at zero, in which its unknowns are expressed.
    pub(crate) axes: Vec<Pose>,
    /// True if the frames of the devices are those of the calibration.
    pub(crate) device_is_known: bool,
}

impl Visit {
    /// Root mean square of positions, metres for each coordinate.
    pub(crate) fn rms(&self) -> f64 {
        let own = self
            .residual
            .iter()
            .zip(&self.quantities)
            .filter(|(_, it)| it.unit() == poecal_numerics::unit::Unit::Metre);
        let (sum, count) = own.fold((0.0, 0.0), |(sum, count), (value, _)| (sum + value * value, count + 1.0));
        if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
    }

    /// The rows of some measurements about the model. The frames of the devices are those of the calibration if `device_is_known`, otherwise fitted;
    /// targets are fitted if `tool_is_anew`.
    pub(crate) fn from_measurements(
        model: &VisitModel,
        original: &Dataset,
        device_is_known: bool,
        options: &TrackOptions,
    ) -> Result<Self> {
        let file = &model.file;
        let shared = file.pictures.as_ref().map(|known| original.with_common(known.common_error()));
        let mut data = shared.as_deref().unwrap_or(original).clone();
        if options.repeatability_m.is_some() {
            // The stated noise of the visit holds for each row.
            data.observations.iter_mut().for_each(|row| (row.stated, row.noise_shape) = Default::default());
        }
        if !options.tool_is_anew {
            file.check_targets(&data)?;
        }
        let devices = if device_is_known { file.devices_of(&data)? } else { Vec::new() };
        let data = faces_on_known_planes(&data, &model.robot, &devices).into_owned();
        let (robot, rows) = (&model.robot, data.all_rows());
        let packed = PackedValues::from_dataset(robot, &data);
        let session = Session::new(robot, &data, &packed, !device_is_known);
        let estimate = place(model, session, (&data, &rows), &devices, options)?;
        let free = unknowns(model, &session, &estimate, &rows);
        let problem = Problem::new(session, rows.clone(), free, model.noise);
        let (starts, mut jacobian, mut residual) = whitened_rows(&problem, &estimate, &rows);
        let mut columns = sort_columns(&problem, robot, &mut jacobian);
        let mut by_known = by_known(model, &session, &estimate, &rows)?;
        let mut lengths = lengths(&columns, &jacobian, &starts, (&data, &estimate, &packed));
        let matrices = std::iter::once(&mut jacobian).chain(&mut by_known).chain(&mut lengths).collect();
        let (sigma, quantities) = unwhiten(&problem, &estimate, (&rows, &starts), &mut residual, matrices);
        if let Some(lengths) = lengths {
            let place = jacobian.ncols();
            jacobian = jacobian.insert_column(place, 0.0);
            jacobian.set_column(place, &lengths.column(0));
            columns.push(ChangeColumns { of: ColumnSubject::Lengths, places: vec![place], turns: vec![false] });
        }
        let motions = |target: usize| {
            let own = problem.layout().parameters().filter_map(|(parameter, _)| parameter.target_motions());
            own.into_iter().find(|(at, _)| *at == target).map_or(&[][..], |(_, motions)| motions)
        };
        let targets = estimate.base_from_target.iter().enumerate();
        let targets = targets.map(|(target, pose)| (*pose, motions(target))).collect();
        Ok(Visit {
            starts,
            jacobian,
            residual,
            sigma,
            quantities,
            columns,
            by_known,
            targets,
            axes: estimate.base_from_axis.clone(),
            device_is_known,
        })
    }
}

/// The estimate of a visit: devices as in the calibration or, like targets of a tool that was mounted anew, registered.
fn place(
    model: &VisitModel,
    session: Session<'_>,
    (data, rows): (&Dataset, &[u32]),
    devices: &[Pose],
    options: &TrackOptions,
) -> Result<Estimate> {
    let mut estimate = nominal_estimate(&model.robot, data);
    for (station, device) in devices.iter().enumerate() {
        *estimate.device_mut(station) = device.inverse();
    }
    if session.device_free || options.tool_is_anew {
        let registration =
            Registration { session, rows, noise: model.noise, targets_free: options.tool_is_anew, prior: None };
        check_count(&registration, data, rows)?;
        estimate = register(&registration, &estimate).0;
    }
    Ok(estimate)
}

/// Scales the columns of a Jacobian to the units of the unknowns, and returns their subjects.
fn sort_columns(problem: &Problem<'_>, robot: &Robot, jacobian: &mut DMatrix<f64>) -> Vec<ChangeColumns> {
    let mut columns = Vec::new();
    for (parameter, places) in problem.layout().parameters() {
        places.iter().for_each(|&(place, scale)| jacobian.column_mut(place).scale_mut(scale));
        let own = places.iter().map(|(place, _)| *place);
        let turns = places.iter().map(|(_, scale)| *scale != 1.0);
        let Some(of) = subject(parameter, robot) else { continue };
        let known =
            columns.iter_mut().find(|it: &&mut ChangeColumns| it.of == of && matches!(of, ColumnSubject::Give(_)));
        match known {
            Some(give) => (give.places.extend(own), give.turns.extend(turns)).0,
            None => columns.push(ChangeColumns { of, places: own.collect(), turns: turns.collect() }),
        }
    }
    columns
}

/// Transforms whitened numbers into metres and radians, positions along the axes of the base; returns the standard deviation and the quantity of
/// each.
fn unwhiten(
    problem: &Problem<'_>,
    estimate: &Estimate,
    (rows, starts): (&[u32], &[usize]),
    residual: &mut DVector<f64>,
    mut matrices: Vec<&mut DMatrix<f64>>,
) -> (DVector<f64>, Vec<Quantity>) {
    let (mut sigma, mut quantities) = (DVector::zeros(residual.len()), Vec::new());
    for (row, &start) in rows.iter().zip(starts) {
        let seen = problem.session().observation(*row);
        let noise = problem.noise(*row as usize);
        let channels = seen.measurement.channels();
        for (at, channel) in channels.iter().enumerate() {
            sigma[start + at] = noise[channel.quantity];
            quantities.push(channel.quantity);
        }
        let of_places = channels.range(Quantity::Position);
        let on_base = matches!(estimate.tree.instruments().get(seen.station), Some(InstrumentMount::On(Body::Base)));
        if of_places.len() == 3 && on_base && seen.noise_shape.is_none() {
            let turn = estimate.device(seen.station).rotation.transpose();
            let first = start + of_places.start;
            for matrix in &mut matrices {
                let own = turn * matrix.rows(first, 3);
                matrix.rows_mut(first, 3).copy_from(&own);
            }
            let own = turn * residual.rows(first, 3);
            residual.rows_mut(first, 3).copy_from(&own);
        }
    }
    for matrix in matrices {
        matrix.row_iter_mut().zip(sigma.iter()).for_each(|(mut row, sigma)| row *= *sigma);
    }
    residual.component_mul_assign(&sigma);
    (sigma, quantities)
}

/// Refuses rows that do not determine the frames of device and tool.
fn check_count(registration: &Registration<'_>, data: &Dataset, rows: &[u32]) -> Result<()> {
    let frames = if registration.session.device_free { 6 * data.station_count() } else { 0 };
    let tool: usize =
        if registration.targets_free { data.target_freedoms(rows).into_iter().map(|it| it.count()).sum() } else { 0 };
    let given: usize = data.observations.iter().map(|row| row.measurement.dim()).sum();
    if given > frames + tool + 1 {
        return Ok(());
    }
    let each = data.observations.first().map_or(3, |row| row.measurement.dim()).max(1);
    let missing = (frames + tool + 2 - given).div_ceil(each);
    ErrorKind::Problem.refuse(format!(
        "found {} measurements with {given} measured numbers, expected more than the {} unknowns of where device and tool are, and one to spare: \
         measure {missing} more configurations{}",
        data.len(),
        frames + tool + 1,
        if frames > 0 { ", or state --device known where the device stands as it did" } else { "" }
    ))
}

/// All possible changes.
fn unknowns(model: &VisitModel, session: &Session<'_>, estimate: &Estimate, rows: &[u32]) -> Vec<Parameter> {
    let data = session.data;
    let stations = (0..data.station_count())
        .filter(|&station| !data.seen_from(station, rows).is_empty() && estimate.tree.shared_target(station).is_none());
    let mut free: Vec<Parameter> = stations.map(|station| device_parameter(data, station, rows)).collect();
    let robot = &model.robot;
    for &joint in &model.joints {
        let kind = robot.joints[joint].kind;
        free.push(Parameter::ScrewAxis(ScrewAxis { joint, kind }));
        free.push(Parameter::ValueTerm(ValueTerm { joint, kind, term: Term::OFFSET }));
    }
    // The last weight alone: the moments of the others at a joint are nearly proportional to its moment.
    let last = robot.gravity.as_ref().map_or(0, |gravity| gravity.weights.len()).checked_sub(1);
    let is_of_last = |term: Term| term.needs_gravity() && last.is_some_and(|last| term.index() == last);
    for it in robot.terms.iter().filter(|it| is_of_last(it.term)) {
        let kind = robot.joints[it.joint].kind;
        let own = &robot.joints[it.joint];
        if own.kind == robot.joints[own.give_of.unwrap_or(it.joint)].kind {
            free.push(Parameter::ValueTerm(ValueTerm { joint: it.joint, kind, term: it.term }));
        }
    }
    free.extend(target_parameters(session, rows));
    free
}

/// Subject of a parameter.
fn subject(parameter: &Parameter, robot: &Robot) -> Option<ColumnSubject> {
    let owner = |joint: usize| robot.joints.get(joint).and_then(|it| it.give_of).unwrap_or(joint);
    Some(match (parameter.model().subject(), parameter.value_term(), parameter.screw_axis()) {
        (ParameterSubject::Instrument(station), ..) => ColumnSubject::Device(station),
        (ParameterSubject::Target(target), ..) => ColumnSubject::Target(target),
        (ParameterSubject::Joint(joint), Some(term), _) if term.term == Term::OFFSET => ColumnSubject::Zero(joint),
        (ParameterSubject::Joint(joint), Some(_), _) => ColumnSubject::Give(owner(joint)),
        (ParameterSubject::Joint(joint), _, Some(_)) => ColumnSubject::Axis(joint),
        _ => return None,
    })
}

/// Derivatives of whitened numbers by the unknowns of the calibration, transformed to independence and variance 1.
fn by_known(
    model: &VisitModel,
    session: &Session<'_>,
    estimate: &Estimate,
    rows: &[u32],
) -> Result<Option<DMatrix<f64>>> {
    let file = &model.file;
    if file.uncertainty.is_none() {
        return Ok(None);
    }
    let names: Vec<Option<&str>> =
        session.data.targets.iter().map(|name| name.as_deref().or(file.unnamed_target())).collect();
    let (found, targets) = file.uncertainty(&names)?;
    // The same unknowns about this visit's estimate: its axes have the frames of the covariance, and its targets their indices.
    let mut about = estimate.clone();
    about.base_from_axis.clone_from(&found.estimate.base_from_axis);
    let n = found.layout.dim();
    let mut free = Vec::new();
    let mut from = Vec::new();
    for (parameter, places) in found.layout.parameters() {
        let parameter = match parameter.target_motions() {
            None => Some(*parameter),
            Some((target, _)) => targets.iter().position(|at| *at == target).map(|own| of_target(parameter, own)),
        };
        let is_device = parameter.is_some_and(|it| matches!(it.model().subject(), ParameterSubject::Instrument(_)));
        if let Some(parameter) = parameter.filter(|_| !is_device) {
            free.push(parameter);
            from.extend(places.iter().map(|(place, _)| *place));
        }
    }
    let session = session.with_length(found.length_m);
    let problem = Problem::new(session, rows.to_vec(), free, model.noise);
    let (_, jacobian, _) = whitened_rows(&problem, &about, rows);
    let mut whole = DMatrix::zeros(jacobian.nrows(), n);
    let own = problem.layout().parameters().flat_map(|(_, places)| places.iter().map(|(place, _)| *place));
    for (place, to) in own.zip(from) {
        whole.set_column(to, &jacobian.column(place));
    }
    // A square root of the covariance, so that the columns are independent of variance 1.
    let (values, vectors) = linalg::symmetric_eigen(&found.covariance, n);
    let roots = DVector::from_iterator(n, values.iter().map(|it| it.max(0.0).sqrt()));
    Ok(Some(whole * vectors * DMatrix::from_diagonal(&roots)))
}

/// The same parameter of another target.
fn of_target(parameter: &Parameter, target: usize) -> Parameter {
    // Parameters without a target are unchanged.
    if let Parameter::TargetFrame(it) = parameter {
        return Parameter::TargetFrame(TargetFrame { target, ..*it });
    }
    if matches!(parameter, Parameter::TargetPlace(_)) {
        return Parameter::TargetPlace(TargetPlace { target });
    }
    *parameter
}

/// The derivative of whitened numbers by a relative growth of all lengths of the arm: the target's position in the base, through the shifts of the
/// device.
fn lengths(
    columns: &[ChangeColumns],
    jacobian: &DMatrix<f64>,
    starts: &[usize],
    (data, estimate, packed): (&Dataset, &Estimate, &PackedValues),
) -> Option<DMatrix<f64>> {
    let linkage = Linkage::new(estimate);
    let mut chain = RowChain::default();
    let mut found = DMatrix::zeros(jacobian.nrows(), 1);
    for (row, seen) in data.observations.iter().enumerate() {
        let is_on_base = matches!(estimate.tree.instruments().get(seen.station), Some(InstrumentMount::On(Body::Base)));
        let device = columns.iter().find(|it| it.of == ColumnSubject::Device(seen.station))?;
        let shifts = device.places.get(..3).filter(|_| is_on_base && !device.turns.iter().take(3).any(|it| *it))?;
        chain.evaluate(&linkage, packed, row, seen);
        let away: Vector3<f64> = chain.target.translation - estimate.device(seen.station).translation;
        for number in starts[row]..starts[row + 1] {
            found[(number, 0)] = (0..3).map(|k| jacobian[(number, shifts[k])] * away[k]).sum();
        }
    }
    Some(found)
}
