//! The tables and keys of the file, as serde reads them.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::robot::{JointKind, Term};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) poecal_robot: Spanned<i64>,
    pub(super) name: Spanned<String>,
    pub(super) length_unit: LengthUnit,
    pub(super) angle_unit: AngleUnit,
    #[serde(default)]
    pub(super) convention: Convention,
    pub(super) base_link: Option<Spanned<String>>,
    pub(super) tip_link: Option<Spanned<String>>,
    pub(super) tip_on: Option<Spanned<String>>,
    pub(super) joint: Vec<JointTable>,
    pub(super) home: Option<Spanned<PoseTable>>,
    pub(super) base: Option<Spanned<PoseTable>>,
    pub(super) tool: Option<Spanned<PoseTable>>,
    #[serde(default)]
    pub(super) target: Vec<TargetTable>,
    #[serde(default)]
    pub(super) instrument: Vec<TargetTable>,
    #[serde(default)]
    pub(super) mass: Vec<MassTable>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LengthUnit {
    M,
    Cm,
    Mm,
    Um,
}

impl LengthUnit {
    /// Divided, not multiplied: 834 mm are exactly the number 0.834.
    pub(super) fn to_metres(self, length: f64) -> f64 {
        match self {
            LengthUnit::M => length,
            LengthUnit::Cm => length / 1e2,
            LengthUnit::Mm => length / 1e3,
            LengthUnit::Um => length / 1e6,
        }
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum AngleUnit {
    Rad,
    Deg,
}

impl AngleUnit {
    pub(super) fn to_radians(self, angle: f64) -> f64 {
        match self {
            AngleUnit::Rad => angle,
            AngleUnit::Deg => angle.to_radians(),
        }
    }
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
pub(super) enum Convention {
    #[default]
    Screws,
    StandardDh,
    ModifiedDh,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JointTable {
    pub(super) name: Spanned<String>,
    pub(super) parent: Option<Spanned<String>>,
    #[serde(default = "revolute", rename = "type")]
    pub(super) kind: JointKind,
    pub(super) screw: Option<Spanned<ScrewTable>>,
    pub(super) point: Option<Spanned<[f64; 3]>>,
    pub(super) direction: Option<Spanned<[f64; 3]>>,
    pub(super) a: Option<Spanned<f64>>,
    pub(super) alpha: Option<Spanned<f64>>,
    pub(super) d: Option<Spanned<f64>>,
    pub(super) theta: Option<Spanned<f64>>,
    pub(super) fixed: Option<Spanned<PoseTable>>,
    pub(super) limits: Option<Spanned<[f64; 2]>>,
    pub(super) mimic: Option<Spanned<MimicTable>>,
    pub(super) tolerance: Option<Spanned<ToleranceTable>>,
    #[serde(default)]
    pub(super) terms: BTreeMap<Term, Spanned<f64>>,
}

impl JointTable {
    pub(super) fn name(&self) -> &str {
        self.name.get_ref()
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ScrewTable {
    pub(super) v: [f64; 3],
    #[serde(default)]
    pub(super) w: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MimicTable {
    pub(super) joint: String,
    #[serde(default = "one")]
    pub(super) multiplier: f64,
    #[serde(default)]
    pub(super) offset: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ToleranceTable {
    pub(super) angle: f64,
    pub(super) length: f64,
}

fn revolute() -> JointKind {
    JointKind::Revolute
}

fn one() -> f64 {
    1.0
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PoseTable {
    pub(super) position: Spanned<[f64; 3]>,
    pub(super) quaternion_xyzw: Option<Spanned<[f64; 4]>>,
    pub(super) rpy: Option<Spanned<[f64; 3]>>,
    pub(super) rotation: Option<Spanned<[[f64; 3]; 3]>>,
}

/// A mass of a link.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MassTable {
    pub(super) on: Spanned<String>,
    pub(super) position: Spanned<[f64; 3]>,
    pub(super) kg: Spanned<f64>,
}

/// A target or an instrument.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TargetTable {
    pub(super) name: Spanned<String>,
    pub(super) on: Option<Spanned<String>>,
    position: Spanned<[f64; 3]>,
    quaternion_xyzw: Option<Spanned<[f64; 4]>>,
    rpy: Option<Spanned<[f64; 3]>>,
    rotation: Option<Spanned<[[f64; 3]; 3]>>,
}

impl TargetTable {
    pub(super) fn pose(&self) -> PoseTable {
        PoseTable {
            position: self.position.clone(),
            quaternion_xyzw: self.quaternion_xyzw.clone(),
            rpy: self.rpy.clone(),
            rotation: self.rotation.clone(),
        }
    }
}
