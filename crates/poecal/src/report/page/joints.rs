//! The robot: its axes in three dimensions, and what was corrected at each joint.

use super::figures;
use super::html::{Html, Table, decimal, figure, quoted, scaled};
use crate::io::calibration_file::{CalibrationFile, KindWord};

pub(super) fn sections(page: &mut Html, file: &CalibrationFile) {
    view(page, file);
    corrections(page, file);
}

fn view(page: &mut Html, file: &CalibrationFile) {
    page.section("view", "In 3D");
    page.text(
        "The arm as lines along its joints' axes: nominal in grey, calibrated in colour. Arrows go from where the calibrated model says \
         that a target is to where it was measured.",
    );
    page.raw("<div id=\"arm\" class=\"arm\"></div>\n<noscript><p class=\"note\">The picture needs JavaScript. All figures are in the tables.</p></noscript>");
    let head = ["joint", "kind", "model", "x", "y", "z", "through x, mm", "y, mm", "z, mm"];
    let mut table = Table::new(
        "Axes in the base frame with all joints at zero: direction, and the point nearest to the base",
        3,
        &head,
    );
    for (k, joint) in file.joints.iter().enumerate() {
        for (model, screw, key) in
            [("nominal", &joint.nominal_screw, "nominal_screw"), ("calibrated", &joint.screw, "screw")]
        {
            let key = format!("joints.{k}.{key}");
            let turns = joint.kind == KindWord::Revolute;
            let (direction, part) = if turns { (screw.w, "w") } else { (screw.v_m, "v_m") };
            let mut cells = vec![
                quoted(&joint.name, &format!("joints.{k}.name")),
                kind_words(joint.kind).to_owned(),
                model.to_owned(),
            ];
            cells.extend((0..3).map(|i| figure(direction[i], &format!("{key}.{part}.{i}"))));
            let point = turns.then(|| cross(screw.w, screw.v_m));
            cells.extend(
                (0..3).map(|i| point.map_or_else(|| "–".to_owned(), |point| decimal(1e3 * point[i], 3))),
            );
            table.rows.push(cells);
        }
    }
    page.folded_table("The axes as numbers", &table);
    page.end_section();
}

fn kind_words(kind: KindWord) -> &'static str {
    match kind {
        KindWord::Revolute => "revolute",
        KindWord::Prismatic => "prismatic",
    }
}

/// The point of an axis nearest to the origin, from its direction and its linear part.
fn cross(w: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [w[1] * v[2] - w[2] * v[1], w[2] * v[0] - w[0] * v[2], w[0] * v[1] - w[1] * v[0]]
}

fn corrections(page: &mut Html, file: &CalibrationFile) {
    page.section("joints", "Joints");
    page.text(
        "By how much each axis was found off its nominal place, how well that is known, and what it is worth: the error that would remain \
         if this axis alone stayed nominal, tool and device found anew.",
    );
    page.plots(&figures::corrections(file), "Dots: what was found. Lines: two standard deviations to each side; none where the data do not tell it.");
    let head = ["joint", "tilt, °", "± (1 σ)", "shift, mm", "± (1 σ)", "left nominal, mm (RMS)"];
    let mut table = Table::new("Corrections of the joints", 1, &head);
    for (k, found) in file.corrections.iter().enumerate() {
        let key = |name: &str| format!("corrections.{k}.{name}");
        let slides =
            file.joints.iter().any(|joint| joint.name == found.joint && joint.kind == KindWord::Prismatic);
        let sigma = |value: Option<f64>, name: &str| {
            value.map_or_else(|| "not told by the data".to_owned(), |value| figure(value, &key(name)))
        };
        let (shift, sigma_shift) = if slides {
            ("–".to_owned(), "–".to_owned())
        } else {
            (figure(found.shift_mm, &key("shift_mm")), sigma(found.sigma_shift_mm, "sigma_shift_mm"))
        };
        table.rows.push(vec![
            quoted(&found.joint, &key("joint")),
            figure(found.tilt_deg, &key("tilt_deg")),
            sigma(found.sigma_tilt_deg, "sigma_tilt_deg"),
            shift,
            sigma_shift,
            figure(found.left_nominal_rms_mm, &key("left_nominal_rms_mm")),
        ]);
    }
    page.table(&table);
    for (k, found) in file.corrections.iter().enumerate() {
        if let Some(words) = &found.suspicious {
            let name = quoted(&found.joint, &format!("corrections.{k}.joint"));
            let words = quoted(words, &format!("corrections.{k}.suspicious"));
            page.text(&format!("<strong>Suspicious: {name}.</strong> {words}."));
        }
    }
    offsets(page, file);
    page.end_section();
}

/// Joint offsets, where the formulation has them.
fn offsets(page: &mut Html, file: &CalibrationFile) {
    let Some(offsets) = &file.solver.joint_offsets else { return };
    let mut table = Table::new(
        "Joint offsets of this formulation; in the calibrated model they stand moved into the axes",
        1,
        &["joint", "offset"],
    );
    for (k, offset) in offsets.iter().enumerate() {
        let key = |name: &str| format!("solver.joint_offsets.{k}.{name}");
        let words = match (offset.offset_deg, offset.offset_mm) {
            (Some(value), _) => format!("{}°", scaled(value, &key("offset_deg"), 1.0)),
            (None, Some(value)) => format!("{} mm", scaled(value, &key("offset_mm"), 1.0)),
            (None, None) => String::new(),
        };
        table.rows.push(vec![quoted(&offset.joint, &key("joint")), words]);
    }
    page.table(&table);
}
