//! Mapping files.

use poecal_import::{ColumnMap, ReadOptions, parse, parse_joints};
use poecal_model::simulate::scara;

use super::tables::{assert_sound, joints_sound};
use crate::properties::{PATH, check_result, text};

/// Files for a mapping: one with names of its own, and one with two targets in a row.
const FILES: [&str; 2] = [
    "run;phase;A1;A2;A3;A4;px;py;pz;a;b;c;s\n1;train;12,5;-40;100;10;512,31;-40,02;130,9;1;2;3;0,1\n\
     2;test;-3;15,25;50;20;540,77;102,4;112,18;4;5;6;0,1\n",
    "joint1[deg],joint2[deg],joint3,joint4,smr1_x,smr1_y,smr1_z,smr2_x,smr2_y,smr2_z,qx,qy,qz,qw\n\
     12.5,-40,0.1,0.2,0.51,-0.04,0.33,,,,0,0,0,1\n-3,15.25,0.2,0.3,0.54,0.1,0.15,0.61,0.14,0.16,0,0,1,0\n",
];

/// A mapping: read, and applied to files.
pub fn mapping(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let Some(mapping) = check_result(ColumnMap::parse(&text, PATH), &text) else { return false };
    let (robot, options) = (scara(), ReadOptions { mapping: Some(mapping), ..ReadOptions::default() });
    for file in FILES {
        if let Some(found) = check_result(parse(file, PATH, &robot, &options), file) {
            assert_sound(&found, file);
        }
        if let Some(found) = check_result(parse_joints(file, PATH, &robot, &options), file) {
            joints_sound(&found, &robot);
        }
    }
    true
}
