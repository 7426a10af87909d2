//! Separation of the observations in messages into pixels and points of a board on the robot.

use nalgebra::Vector3;

use super::parsed_message::{ParsedMessage, PartRefusal as _, SensorObservation};
use crate::pictures::boards::FARTHEST_M;
use poecal_model::camera::Board;
use poecal_numerics::error::{ErrorKind, Result};

/// Distance up to which two positions are one point of a board, metres.
const SAME_M: f64 = 1e-6;
/// Ratio of the number of positions to that of points in a message beyond which the points move.
const MOVES: f64 = 1.5;

/// A message, sorted.
pub(crate) struct SortedMessage<'a> {
    pub(crate) message: &'a ParsedMessage<'a>,
    /// Observations in pixels.
    pub(crate) pixels: Vec<&'a SensorObservation<'a>>,
    /// Observations of points in the frame of a link: the body, and the indices of its points.
    points: Vec<(usize, Vec<usize>)>,
}

/// Points on a link that a sensor states, metres.
pub(crate) struct SensorPoints {
    pub(crate) sensor: String,
    /// The points, under the name of their frame.
    pub(crate) board: Board,
    /// Largest number of points in a message.
    most: usize,
}

/// The bodies of all messages.
#[derive(Default)]
pub(crate) struct MessageBodies(pub(crate) Vec<SensorPoints>);

/// True if an observation is one of pixels; an observation of points in space by a camera is refused by name.
fn are_pixels(observation: &SensorObservation<'_>) -> Result<bool> {
    let SensorObservation { node, sensor, features, .. } = observation;
    let deep = features.iter().find(|it| it.at[2] != 0.0);
    let is_wide = features.iter().any(|it| it.at[0].abs().max(it.at[1].abs()) > FARTHEST_M);
    let is_camera = observation.camera.is_some() || is_wide;
    if let (true, Some(deep)) = (is_camera, deep) {
        let [x, y, z] = deep.at;
        return deep.node.refuse(format!(
            "found the feature ({x}, {y}, {z}) of the sensor `{sensor}`, as a 3-D camera sees it, expected pixels: x and y, with z = 0"
        ));
    }
    if !is_camera && observation.frame.is_empty() {
        return features.first().map_or(*node, |it| it.node).refuse(format!(
            "found points of the sensor `{sensor}` without `frame_id`, expected the link that they are on"
        ));
    }
    Ok(is_camera)
}

impl SensorPoints {
    /// Index of a point, which is added if no message had it before.
    fn index(&mut self, at: [f64; 3]) -> usize {
        let place = Vector3::from(at);
        let Board { names, points, .. } = &mut self.board;
        points.iter().position(|it| (it - place).norm() <= SAME_M).unwrap_or_else(|| {
            names.push(format!("point{}", points.len()));
            points.push(place);
            points.len() - 1
        })
    }
}

impl MessageBodies {
    /// Takes the points of a message.
    pub(crate) fn take<'a>(&mut self, message: &'a ParsedMessage<'a>) -> Result<SortedMessage<'a>> {
        let (mut pixels, mut points) = (Vec::new(), Vec::new());
        for observation in message.observations.iter().filter(|it| !it.features.is_empty()) {
            if are_pixels(observation)? {
                pixels.push(observation);
                continue;
            }
            let SensorObservation { sensor, frame, features, .. } = observation;
            let is_it = |body: &SensorPoints| body.sensor == *sensor && body.board.name == *frame;
            let at = self.0.iter().position(is_it).unwrap_or_else(|| {
                let board = Board { name: (*frame).to_owned(), ..Board::default() };
                self.0.push(SensorPoints { sensor: (*sensor).to_owned(), board, most: 0 });
                self.0.len() - 1
            });
            if let Some(body) = self.0.get_mut(at) {
                body.most = body.most.max(features.len());
                points.push((at, features.iter().map(|it| body.index(it.at)).collect()));
            }
        }
        Ok(SortedMessage { message, pixels, points })
    }

    /// Refuses points whose positions differ from message to message: a camera saw them in space.
    pub(crate) fn refuse_moving(&self) -> Result<()> {
        let moves = |body: &&SensorPoints| body.board.points.len() as f64 > MOVES * body.most as f64;
        let Some(SensorPoints { sensor, board, .. }) = self.0.iter().find(moves) else { return Ok(()) };
        ErrorKind::Measurement.refuse(format!(
            "found features of the sensor `{sensor}` in metres that move in its frame `{}` from message to message, as a 3-D camera sees them, expected \
             pixels (x and y, with z = 0), or points that stay in the frame of a link",
            board.name
        ))
    }
}

impl SortedMessage<'_> {
    /// The points of the message that an observation of pixels sees: the ones with the same number of features.
    pub(crate) fn partner(&self, observation: &SensorObservation<'_>) -> Result<&(usize, Vec<usize>)> {
        let (count, sensor) = (observation.features.len(), observation.sensor);
        let alike: Vec<_> = self.points.iter().filter(|it| it.1.len() == count).collect();
        match alike[..] {
            [one] => Ok(one),
            [] => self.message.node.refuse(format!(
                "found {count} features of `{sensor}` in pixels and no other sensor with as many points in metres, expected the board: state it with --markers"
            )),
            _ => observation.node.refuse(format!(
                "found two sensors with the {count} points that `{sensor}` sees in pixels, expected one"
            )),
        }
    }
}
