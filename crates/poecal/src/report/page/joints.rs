//! The robot: its axes in three dimensions, and what was corrected at each joint.

use maud::{Markup, html};
use nalgebra::Vector3;

use super::devices::{device_of, further, picture_words};
use super::figures;
use super::frames::draws_instruments;
use super::html::{HtmlTable, decimal, figure, figure_or, folded, list, plots, quoted, section};
use super::sides::still;
use crate::io::calibration_file::{CalibrationFile, JointEntry, ScrewEntry, StationEntry};
use crate::io::shapes::Shapes;
use crate::measurement::Device;
use crate::robot::{Body, JointKind};

pub(super) fn sections(file: &CalibrationFile, shapes: &Shapes) -> Markup {
    html! { (view(file, shapes)) (corrections(file)) }
}

fn view(file: &CalibrationFile, shapes: &Shapes) -> Markup {
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
    let content = html! {
        p {
            "The " (if draws_instruments(file) { "robot" } else { "arm" })
            @if shapes.shapes.is_empty() { " as links from axis to axis" } @else { " with the shapes of its URDF" }
            ": nominal in grey, calibrated in colour."
            (picture_words(file, draws_instruments(file)))
        }
        div #still.still { (plots(&still(file), "The calibrated robot in the middle of the sampled range.")) }
        div #arm.arm {}
        @if !shapes.notes.is_empty() { p.note { (shapes.notes.join(" ").replace('`', "")) } }
        noscript { p.note { "The picture that turns needs JavaScript." } }
        (folded("The axes as numbers", &table))
        @if let Some(table) = targets(file) { (table) }
        @if let Some(table) = stands(file) { (folded("What stands where", &table)) }
    };
    section("view", "In 3D", &content)
}

/// A joint's axis in one of the models.
fn axis(
    table: &mut HtmlTable,
    (k, joint): (usize, &JointEntry),
    (model, screw, key): (&str, &ScrewEntry, &str),
) {
    let turns = joint.kind == JointKind::Revolute;
    let (direction, part) = if turns { (screw.w, "w") } else { (screw.v_m, "v_m") };
    let [x, y, z] = [0, 1, 2].map(|i| figure(direction[i], format_args!("joints.{k}.{key}.{part}.{i}")));
    // The point of the axis nearest to the origin.
    let point: [f64; 3] = Vector3::from(screw.w).cross(&Vector3::from(screw.v_m)).into();
    let point = point.map(|it| if turns { decimal(1e3 * it, 3) } else { "–".to_owned() });
    let name = quoted(&joint.name, format_args!("joints.{k}.name"));
    table.row(&[&name, &joint.kind.word(), &model, &x, &y, &z, &point[0], &point[1], &point[2]]);
}

/// Where the targets on the link of the tip are.
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

/// On which body instruments, targets and the first joints of branches stand, where the picture has them.
fn stands(file: &CalibrationFile) -> Option<HtmlTable> {
    let robot = file.robot().ok().filter(|_| draws_instruments(file))?;
    let mut table = HtmlTable::new(
        "What stands on which body, and where in the base frame with all joints at zero",
        3,
        &["name", "kind", "stands on", "x, mm", "y, mm", "z, mm", "and"],
    );
    // A direction has no place.
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
        let further = station.map(|k| further(file, k, &pose)).unwrap_or_default();
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
        let further = station.base_from_device.pose().map(|pose| further(file, k, &pose));
        let place = (kind != Device::Direction).then_some(station.base_from_device.position_m.into());
        row(name, kind.word(), Body::Base, place, &further.unwrap_or_default());
    }
    if file.stations.is_empty() {
        let place = file.measurement_frame.base_from_device.position_m.into();
        row("instrument", "instrument", Body::Base, Some(place), &Markup::default());
    }
    Some(table)
}

fn corrections(file: &CalibrationFile) -> Markup {
    let head = [
        "joint",
        "tilt, °",
        "± (1 σ)",
        "by data",
        "shift, mm",
        "± (1 σ)",
        "by data",
        "left nominal, mm (RMS)",
    ];
    let mut table = HtmlTable::new("Corrections of the joints", 1, &head);
    for (k, found) in file.corrections.iter().enumerate() {
        let slides =
            file.joints.iter().any(|joint| joint.name == found.joint && joint.kind == JointKind::Prismatic);
        let figure = |value, name| figure_or(value, format_args!("corrections.{k}.{name}"), "not determined");
        let shift = |value, name| {
            if slides {
                html! { "–" }
            } else {
                figure(value, name)
            }
        };
        table.row(&[
            &quoted(&found.joint, format_args!("corrections.{k}.joint")),
            &figure(Some(found.tilt_deg), "tilt_deg"),
            &figure(found.sigma_tilt_deg, "sigma_tilt_deg"),
            &figure_or(found.tilt_from_data, format_args!("corrections.{k}.tilt_from_data"), "–"),
            &shift(Some(found.shift_mm), "shift_mm"),
            &shift(found.sigma_shift_mm, "sigma_shift_mm"),
            &figure_or(found.shift_from_data, format_args!("corrections.{k}.shift_from_data"), "–"),
            &figure(Some(found.left_nominal_rms_mm), "left_nominal_rms_mm"),
        ]);
    }
    let content = html! {
        p {
            "Correction of each axis from nominal, its standard deviation, and its effect: the error that would remain if this axis alone \
             stayed nominal while all others are as calibrated, with tool and device refitted. The effect can be large even where the uncertainty \
             is large, because neighbouring axes compensate for each other. By data: the measurements' share in what is known of the axis, from 0 to 1; the \
             rest was said by the tolerance."
        }
        (plots(&figures::corrections(file), "Dots: corrections. Lines: two standard deviations to each side; none where a correction is not determined."))
        (changes(file))
        (table)
        (common(file))
        @for (k, found) in file.corrections.iter().enumerate() {
            @if let Some(words) = &found.suspicious {
                p {
                    strong { "Suspicious: " (quoted(&found.joint, format_args!("corrections.{k}.joint"))) "." } " "
                    (quoted(words, format_args!("corrections.{k}.suspicious"))) "."
                }
            }
        }
        (offsets(file))
    };
    section("joints", "Joints", &content)
}

/// The corrections in words, with directions.
fn changes(file: &CalibrationFile) -> Markup {
    let mut table = HtmlTable::new("The corrections in words", 2, &["joint", "correction"]);
    let mut any = false;
    for (k, found) in file.corrections.iter().enumerate() {
        let Some(change) = &found.change else { continue };
        any = true;
        table.row(&[
            &quoted(&found.joint, format_args!("corrections.{k}.joint")),
            &quoted(&change.words, format_args!("corrections.{k}.change.words")),
        ]);
    }
    if !any {
        return Markup::default();
    }
    html! {
        (table)
        p.note {
            "Directions of the base frame with all joints at zero; a shift is that of the axis' point nearest to the joint's origin. "
            "An offset is to be added to the joint's value: it turns or shifts everything beyond the joint. Tilts and shifts are what offsets and the base "
            "do not explain, so they may be smaller than in the table above. The offset of the first joint is not determined where the base "
            "was fitted, that of the last where the tool was."
        }
    }
}

/// What is known of several joints only together.
fn common(file: &CalibrationFile) -> Markup {
    if file.common.is_empty() {
        return Markup::default();
    }
    let mut table = HtmlTable::new(
        "Standard deviations of each axis, all axes unknown and those of the other joints held",
        1,
        &["joint", "tilt, °", "others held", "shift, mm", "others held"],
    );
    for (k, found) in file.corrections.iter().enumerate() {
        let figure =
            |value, name: &str, words| figure_or(value, format_args!("corrections.{k}.{name}"), words);
        table.row(&[
            &quoted(&found.joint, format_args!("corrections.{k}.joint")),
            &figure(found.sigma_tilt_deg, "sigma_tilt_deg", "not determined"),
            &figure(found.sigma_tilt_held_deg, "sigma_tilt_held_deg", "–"),
            &figure(found.sigma_shift_mm, "sigma_shift_mm", "not determined"),
            &figure(found.sigma_shift_held_mm, "sigma_shift_held_mm", "–"),
        ]);
    }
    let items = file.common.iter().enumerate();
    let items = items.map(|(k, it)| quoted(&it.words, format_args!("common.{k}.words")));
    html! {
        h3 { "Known only together" }
        p {
            "Some standard deviations are large because these joints can change together with little effect on what was measured; with the \
             others held each is known better. One standard deviation of each such direction:"
        }
        (list(&items.collect::<Vec<_>>()))
        (folded("Standard deviations with the others held", &table))
    }
}

/// Joint offsets, where the formulation has them.
fn offsets(file: &CalibrationFile) -> Markup {
    let Some(offsets) = &file.solver.joint_offsets else { return Markup::default() };
    let mut table = HtmlTable::new(
        "Joint offsets of this formulation; in the calibrated model they are part of the axes",
        1,
        &["joint", "offset"],
    );
    for (k, offset) in offsets.iter().enumerate() {
        let figure = |value, name| figure(value, format_args!("solver.joint_offsets.{k}.{name}"));
        let words = match (offset.offset_deg, offset.offset_mm) {
            (Some(value), _) => html! { (figure(value, "offset_deg")) "°" },
            (None, Some(value)) => html! { (figure(value, "offset_mm")) " mm" },
            (None, None) => Markup::default(),
        };
        table.row(&[&quoted(&offset.joint, format_args!("solver.joint_offsets.{k}.joint")), &words]);
    }
    html! { (table) }
}
