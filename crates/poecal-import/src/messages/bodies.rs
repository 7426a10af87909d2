//! Which observations of messages are pixels, and which are the points of a board on the robot.

use std::path::Path;

use nalgebra::Vector3;

use super::parsed::{Message, Observation};
use crate::pictures::boards::FARTHEST_M;
use poecal_model::camera::Board;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Distance up to which two places are one point of a board, metres.
const SAME_M: f64 = 1e-6;
/// How many times as many places as points in a message are those of something that moves.
const MOVES: f64 = 1.5;

/// What the features of an observation are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seen {
    Nothing,
    Pixels,
    /// Points in the frame of a link, metres.
    Points,
}

/// What an observation is; one of a camera that sees points in space is refused by name.
pub(crate) fn seen(observation: &Observation<'_>, path: &Path) -> Result<Seen> {
    let features = &observation.features;
    let Some(first) = features.first() else { return Ok(Seen::Nothing) };
    let deep = features.iter().find(|it| it.at[2] != 0.0);
    let is_wide = features.iter().any(|it| it.at[0].abs().max(it.at[1].abs()) > FARTHEST_M);
    match (observation.camera.is_some() || is_wide, deep) {
        (true, None) => Ok(Seen::Pixels),
        (true, Some(deep)) => {
            let message = format!(
                "found the feature ({}, {}, {}) of the sensor `{}`, as a 3-D camera sees it, expected pixels: x and y, with z = 0",
                deep.at[0], deep.at[1], deep.at[2], observation.sensor
            );
            Err(deep.node.error(path, message))
        }
        (false, _) if observation.frame.is_empty() => {
            let message = format!(
                "found points of the sensor `{}` without `frame_id`, expected the link that they are on",
                observation.sensor
            );
            Err(first.node.error(path, message))
        }
        (false, _) => Ok(Seen::Points),
    }
}

/// Points on a link that a sensor states.
pub(crate) struct Body {
    pub(crate) sensor: String,
    /// By the frame of the points.
    pub(crate) board: Board,
    /// Most points in a message.
    most: usize,
}

impl Body {
    /// Index of a point, which is new or was there in a message before.
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

/// The bodies of all messages.
#[derive(Default)]
pub(crate) struct Bodies(pub(crate) Vec<Body>);

impl Bodies {
    /// Takes an observation of points: the body, and which of its points they are.
    pub(crate) fn take(&mut self, observation: &Observation<'_>) -> (usize, Vec<usize>) {
        let Observation { sensor, frame, features, .. } = observation;
        let is_it = |body: &Body| body.sensor == *sensor && body.board.name == *frame;
        let at = self.0.iter().position(is_it).unwrap_or_else(|| {
            let board = Board { name: (*frame).to_owned(), ..Board::default() };
            self.0.push(Body { sensor: (*sensor).to_owned(), board, most: 0 });
            self.0.len() - 1
        });
        let Some(body) = self.0.get_mut(at) else { return (at, Vec::new()) };
        body.most = body.most.max(features.len());
        (at, features.iter().map(|feature| body.index(feature.at)).collect())
    }

    /// Refuses points that are at other places in each message: those are what a camera saw in space.
    pub(crate) fn refuse_moving(&self, path: &Path) -> Result<()> {
        let moves = |body: &&Body| body.board.points.len() as f64 > MOVES * body.most as f64;
        let Some(body) = self.0.iter().find(moves) else { return Ok(()) };
        let message = format!(
            "found features of the sensor `{}` in metres that move in its frame `{}` from message to message, as a 3-D camera sees them, expected \
             pixels (x and y, with z = 0), or points that stay in the frame of a link",
            body.sensor, body.board.name
        );
        Err(Error::new(ErrorKind::Measurement, message).in_file(path))
    }
}

/// The points of a message that an observation of pixels sees: those of as many features.
pub(crate) fn partner<'a>(
    message: &Message<'_>,
    observation: &Observation<'_>,
    points: &'a [(usize, Vec<usize>)],
    path: &Path,
) -> Result<&'a (usize, Vec<usize>)> {
    let count = observation.features.len();
    let mut alike = points.iter().filter(|(_, own)| own.len() == count);
    match (alike.next(), alike.next()) {
        (Some(one), None) => Ok(one),
        (Some(_), Some(_)) => {
            let text = format!(
                "found two sensors with the {count} points that `{}` sees in pixels, expected one",
                observation.sensor
            );
            Err(observation.node.error(path, text))
        }
        (None, _) => {
            let text = format!(
                "found {count} features of `{}` in pixels and no other sensor with as many points in metres, expected the board: state it with --markers",
                observation.sensor
            );
            Err(message.node.error(path, text))
        }
    }
}
