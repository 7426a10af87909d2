//! Devices and references of the measurements: instruments with frames of their own, anchors, sockets, planes, spheres, directions, pairs of
//! configurations.

use maud::{Markup, Render, html};

use super::html::{decimal, figure, quote_text};
use crate::summary::delivered_name;
use poecal_arm::lie::Pose;
use poecal_model::measurement::Device;
use poecal_results::calibration_file::{CalibrationFile, StationEntry};

/// Kind of a calibration's station; an instrument if its file does not state it.
pub(crate) fn device_of(station: &StationEntry) -> Device {
    let word = station.kind.as_deref().unwrap_or_default();
    Device::ALL.into_iter().find(|it| it.word() == word).unwrap_or(Device::Instrument)
}

/// The devices of a calibration, each once, in the order of [`Device::ALL`].
pub(crate) fn devices(file: &CalibrationFile) -> Vec<Device> {
    let found: Vec<Device> = file.stations.iter().map(device_of).collect();
    match found.as_slice() {
        [] => vec![Device::Instrument],
        found => Device::ALL.into_iter().filter(|it| found.contains(it)).collect(),
    }
}

/// Symbol of a device in the picture; `None` for a pair, which has no pose of its own.
fn drawn_words(device: Device) -> Option<&'static str> {
    Some(match device {
        Device::Instrument => "instruments as their frames, x in red, y in green, z in blue",
        Device::Anchor => {
            "anchors as balls, those beside the robot with thin lines to some of the places that they measured"
        }
        Device::Socket => "sockets as cups",
        Device::Plane => "planes as sheets under the places that touched them, with their normals",
        Device::Sphere => "the sphere in its true size",
        Device::Direction => "the direction that was seen as an arrow at the tool",
        Device::Pair => return None,
    })
}

/// End point of a residual's arrow; `None` if a residual has no position in the picture.
fn arrow_words(device: Device) -> Option<&'static str> {
    Some(match device {
        Device::Instrument => "to its measured place",
        Device::Anchor => "along the line to the anchor, by what it was measured to be farther or nearer",
        Device::Socket => "to the middle of the socket",
        Device::Plane => "along the plane's normal to the height measured",
        Device::Sphere => "to the sphere that it touched",
        Device::Direction | Device::Pair => return None,
    })
}

/// True if only cameras measured.
fn is_of_pictures(file: &CalibrationFile) -> bool {
    let count = file.accuracy.training.count + file.accuracy.held_out.as_ref().map_or(0, |set| set.count);
    file.pictures.as_ref().is_some_and(|pictures| pictures.count == count)
}

/// Description of the picture, in sentences.
pub(crate) fn picture_words(file: &CalibrationFile, draws_places: bool) -> Markup {
    let all = devices(file);
    let arrows: Vec<&str> = all.iter().filter_map(|it| arrow_words(*it)).collect();
    let has_dots = all.iter().any(|it| arrow_words(*it).is_none());
    let drawn: Vec<&str> = all.iter().filter_map(|it| drawn_words(*it)).collect();
    let seeing = match [Device::Instrument, Device::Anchor].map(|it| all.contains(&it)) {
        [true, true] => Some("instrument or anchor"),
        [true, false] => Some("instrument"),
        [false, true] => Some("anchor"),
        [false, false] => None,
    };
    html! {
        @if !arrows.is_empty() {
            " Arrows go from the place of a target by the " (delivered_name(file)) " model " (arrows.join(", or ")) "."
        }
        @if has_dots {
            " Dots are at the places of targets " @if !arrows.is_empty() { "whose residual is no shift in the picture" } @else { "that were measured" }
            ": the stronger the colour, the larger the error."
        }
        @if file.pictures.is_some() {
            " A camera is drawn as the pyramid of what it sees, a board with its points; lines go from the camera of the chosen picture to the corners \
             of its board."
        }
        @if draws_places && !drawn.is_empty() && !is_of_pictures(file) {
            " Also drawn: " (drawn.join("; ")) "."
            @if let Some(seeing) = seeing {
                " A dashed line goes from the " (seeing) " of the chosen measurement to its target."
            }
        }
    }
}

/// Estimated poses of instruments and references, by kind: the fact *Device frame* and the like, with its label.
pub(crate) fn found_words(file: &CalibrationFile) -> (&'static str, Markup) {
    let all = devices(file);
    if all == [Device::Instrument] {
        let words = html! {
            "fitted with the robot"
            @if file.stations.len() > 1 { ", one for each of the instruments " (names(file, Device::Instrument)) }
        };
        return ("Device frame", words);
    }
    if all == [Device::Pair] {
        return ("Device frame", html! { "none: each measurement is of two configurations of the robot" });
    }
    let words = html! {
        "fitted with the robot: "
        @for (k, place) in all.into_iter().filter(|it| *it != Device::Pair).enumerate() {
            @if k > 0 { "; " }
            (place.word()) @if file.stations.iter().filter(|it| device_of(it) == place).count() > 1 { "s" }
            " " (names(file, place))
        }
    };
    ("Places", words)
}

/// The names of all stations of a kind.
fn names(file: &CalibrationFile, place: Device) -> Markup {
    let own = file.stations.iter().enumerate().filter(|(_, it)| device_of(it) == place);
    let names = own.filter_map(|(k, it)| Some((k, it.instrument.as_deref()?)));
    html! {
        @for (n, (k, name)) in names.enumerate() {
            @if n > 0 { ", " } (quote_text(name, format_args!("stations.{k}.instrument")))
        }
    }
}

/// Further estimates of a station: a plane's normal, a direction, a radius, zero and scale of distances.
pub(crate) fn station_details(file: &CalibrationFile, index: usize, pose: &Pose) -> Markup {
    let Some(station) = file.stations.get(index) else { return Markup::default() };
    let place = device_of(station);
    let z = pose.rotation.column(2).into_owned();
    let direction = format!("{}, {}, {}", decimal(z.x, 4), decimal(z.y, 4), decimal(z.z, 4));
    let mut parts: Vec<Markup> = Vec::new();
    match place {
        Device::Plane => parts.push(html! { "normal " (direction) }),
        Device::Direction => parts.push(html! { "along " (direction) }),
        Device::Sphere => {
            let radius = |it| html! { "radius " (figure(it, format_args!("stations.{index}.radius_mm"))) " mm" };
            parts.extend(station.radius_mm.map(radius));
        }
        Device::Instrument | Device::Anchor | Device::Socket | Device::Pair => {
            let zero = |it| html! { "zero " (figure(it, format_args!("stations.{index}.zero_mm"))) " mm" };
            parts.extend(station.zero_mm.map(zero));
        }
    }
    let scale = |it| html! { "scale " (figure(it, format_args!("stations.{index}.scale"))) };
    parts.extend(station.scale.map(scale));
    html! { @for (k, part) in parts.iter().enumerate() { @if k > 0 { ", " } (part.render()) } }
}
