//! The robot in three dimensions, and the corrections of each joint.

use maud::{Markup, html};
use nalgebra::Vector3;

use super::devices::{device_of, picture_words, station_details};
use super::figures;
use super::frames::draws_instruments;
use super::html::{HtmlTable, decimal, figure, fold_table, plots, quote_text, section};
use super::sides::draw_robot;
use poecal_model::measurement::Device;
use poecal_model::robot::{Body, JointKind};
use poecal_results::calibration_file::{CalibrationFile, JointEntry, ScrewEntry, StationEntry};
use poecal_results::shapes::Shapes;

/// The robot in three dimensions, and the poses of all objects.
pub(crate) fn view(file: &CalibrationFile, shapes: &Shapes) -> Markup {
    let head = ["joint", "kind", "model", "x", "y", "z", "through x, mm", "y, mm", "z, mm"];
    let mut table = HtmlTable::new(
        "Axes in the base frame with all joints at zero: direction, and the point nearest to the base",
        3,
        &head,
    );
    for (k, joint) in file.joints.iter().enumerate() {
        axis(&mut table, (k, joint), ("nominal", &joint.nominal_screw, "nominal_screw"));
        axis(&mut table, (k, joint), ("calibrated", &joint.screw, "screw"));
    }
    html! {
        section.view #view aria-label="The robot in 3D" {
            div #still.still { (plots(&draw_robot(file), "The calibrated robot in the middle of the sampled range.")) }
            div #arm.arm {}
            p.note.of-scene {
                "The " (if draws_instruments(file) { "robot" } else { "arm" })
                @if shapes.shapes.is_empty() { " as links from axis to axis" } @else { " with the shapes of its URDF" }
                ": nominal in grey, calibrated in colour."
                (picture_words(file, draws_instruments(file)))
            }
            @if !shapes.notes.is_empty() { p.note { (shapes.notes.join(" ").replace('`', "")) } }
            noscript { p.note { "The picture that turns needs JavaScript." } }
            (fold_table("The axes as numbers", &table))
            @if let Some(table) = targets(file) { (fold_table("The targets as numbers", &table)) }
            @if let Some(table) = stands(file) { (fold_table("What stands where", &table)) }
        }
        "\n"
    }
}

/// A joint's axis in one of the models.
fn axis(table: &mut HtmlTable, (k, joint): (usize, &JointEntry), (model, screw, key): (&str, &ScrewEntry, &str)) {
    let turns = joint.kind == JointKind::Revolute;
    let (direction, part) = if turns { (screw.w, "w") } else { (screw.v_m, "v_m") };
    let [x, y, z] = [0, 1, 2].map(|i| figure(direction[i], format_args!("joints.{k}.{key}.{part}.{i}")));
    // The point of the axis nearest to the origin.
    let point: [f64; 3] = Vector3::from(screw.w).cross(&Vector3::from(screw.v_m)).into();
    let point = point.map(|it| if turns { decimal(1e3 * it, 3) } else { "–".to_owned() });
    let name = quote_text(&joint.name, format_args!("joints.{k}.name"));
    table.row(&[&name, &joint.kind.word(), &model, &x, &y, &z, &point[0], &point[1], &point[2]]);
}

/// Positions of the targets on the link of the tip.
fn targets(file: &CalibrationFile) -> Option<HtmlTable> {
    let link = if file.robot.tip_link.is_empty() { "the tip" } else { &file.robot.tip_link };
    let title = format!("Targets in the frame of {link}");
    let mut table = HtmlTable::new(&title, 1, &["target", "x, mm", "y, mm", "z, mm"]);
    for (name, target) in file.targets.iter().filter(|(_, target)| target.on.is_none()) {
        let [x, y, z] = target.position_m.map(|it| decimal(1e3 * it, 3));
        table.row(&[&name, &x, &y, &z]);
    }
    file.targets.values().any(|target| target.on.is_none()).then_some(table)
}

/// Bodies that carry instruments, targets and the first joints of branches, if the picture has them.
fn stands(file: &CalibrationFile) -> Option<HtmlTable> {
    let robot = file.robot().ok().filter(|_| draws_instruments(file))?;
    let mut table = HtmlTable::new(
        "What stands on which body, and where in the base frame with all joints at zero",
        3,
        &["name", "kind", "stands on", "x, mm", "y, mm", "z, mm", "and"],
    );
    // A direction has no position.
    let mut row = |name: &str, kind: &str, body: Body, place: Option<Vector3<f64>>, further: &Markup| {
        let on = match body.joint().and_then(|joint| robot.joints.get(joint)) {
            Some(joint) => format!("link of {}", joint.name),
            None => "base".to_owned(),
        };
        let [x, y, z] = match place {
            Some(place) => <[f64; 3]>::from(place).map(|it| decimal(1e3 * it, 3)),
            None => [(); 3].map(|()| "–".to_owned()),
        };
        table.row(&[&name, &kind, &on, &x, &y, &z, further]);
    };
    for (k, joint) in robot.joints.iter().enumerate().filter(|(_, joint)| joint.stands_on.is_some()) {
        row(&joint.name, "joint", robot.body_before(k), Some(joint.frame.translation), &Markup::default());
    }
    for mount in &robot.instruments {
        let own = |it: &StationEntry| it.instrument.as_deref() == Some(&mount.name);
        let station = file.stations.iter().position(own);
        let kind = station.and_then(|k| file.stations.get(k)).map_or(Device::Instrument, device_of);
        let pose = robot.base_from(mount);
        let further = station.map(|k| station_details(file, k, &pose)).unwrap_or_default();
        row(&mount.name, kind.word(), mount.body, Some(pose.translation), &further);
    }
    for mount in &robot.mounted {
        row(&mount.name, "target", mount.body, Some(robot.base_from(mount).translation), &Markup::default());
    }
    for (k, station) in file.stations.iter().enumerate() {
        let (name, kind) = (station.instrument.as_deref().unwrap_or("instrument"), device_of(station));
        if kind == Device::Pair || file.instruments.contains_key(name) {
            continue;
        }
        let further = station.base_from_device.pose().map(|pose| station_details(file, k, &pose));
        let place = (kind != Device::Direction).then_some(station.base_from_device.position_m.into());
        row(name, kind.word(), Body::Base, place, &further.unwrap_or_default());
    }
    if file.stations.is_empty() {
        let place = file.measurement_frame.base_from_device.position_m.into();
        row("instrument", "instrument", Body::Base, Some(place), &Markup::default());
    }
    Some(table)
}

/// The correction of each joint: one definition, that of theory.md §8 (38e).
pub(crate) fn corrections(file: &CalibrationFile) -> Markup {
    let head = ["joint", "correction", "left nominal, mm (RMS)"];
    let mut table = HtmlTable::new("Corrections of the joints", 2, &head);
    for (k, found) in file.corrections.iter().enumerate() {
        let change = found.change.as_ref();
        let words = change.map(|it| quote_text(&it.words, format_args!("corrections.{k}.change.words")));
        table.row(&[
            &quote_text(&found.joint, format_args!("corrections.{k}.joint")),
            &words.unwrap_or_else(|| html! { "–" }),
            &figure(found.left_nominal_rms_mm, format_args!("corrections.{k}.left_nominal_rms_mm")),
        ]);
    }
    let content = html! {
        p {
            "Every ± on this page is one standard deviation of the fit with its prior, and so are the lines and bands of the charts. Left nominal: the error that would \
             remain if this axis alone stayed nominal, with tool and device refitted. It can be large even where the uncertainty is large, because \
             neighbouring axes compensate for each other."
        }
        div.wide { (table) }
        p.note {
            "Shift, tilt and offset of each axis, in directions of the base frame with all joints at zero; the shift is that of the axis' point \
             nearest to the joint's origin. Any part of a correction that an offset can explain is counted as offset. " strong {
                "These offsets are not for entering into a controller"
            } ": they hold together with the shifts and tilts. " code { "poecal offsets" } " gives those with which the tip comes nearest if they \
             alone are entered. The first joint's offset is not determined if the base was fitted, the last joint's if the tool was."
        }
        (plots(&figures::corrections(file), "Dots: size of tilt and shift. Lines: ±; none where a correction is not determined."))
        @for (k, found) in file.corrections.iter().enumerate() {
            @if let Some(words) = &found.suspicious {
                p {
                    strong { "Suspicious: " (quote_text(&found.joint, format_args!("corrections.{k}.joint"))) "." } " "
                    (quote_text(words, format_args!("corrections.{k}.suspicious"))) "."
                }
            }
        }
    };
    section("joints", "Joints", &content)
}
