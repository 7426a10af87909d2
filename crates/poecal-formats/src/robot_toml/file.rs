//! The tables and keys of the file, for serde.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use poecal_model::robot::{JointKind, Term};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RobotTomlFile {
    pub(crate) poecal_robot: Spanned<i64>,
    pub(crate) name: Spanned<String>,
    pub(crate) length_unit: LengthUnit,
    pub(crate) angle_unit: AngleUnit,
    #[serde(default)]
    pub(crate) convention: RobotFileConvention,
    pub(crate) base_link: Option<Spanned<String>>,
    pub(crate) tip_link: Option<Spanned<String>>,
    pub(crate) tip_on: Option<Spanned<String>>,
    pub(crate) joint: Vec<JointTable>,
    pub(crate) home: Option<Spanned<PoseTable>>,
    pub(crate) base: Option<Spanned<PoseTable>>,
    pub(crate) tool: Option<Spanned<PoseTable>>,
    #[serde(default)]
    pub(crate) target: Vec<TargetTable>,
    #[serde(default)]
    pub(crate) instrument: Vec<TargetTable>,
    #[serde(default)]
    pub(crate) mass: Vec<MassTable>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum LengthUnit {
    M,
    Cm,
    Mm,
    Um,
}

impl LengthUnit {
    /// Division instead of multiplication: 834 mm are exactly the number 0.834.
    pub(crate) fn to_metres(self, length: f64) -> f64 {
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
pub(crate) enum AngleUnit {
    Rad,
    Deg,
}

impl AngleUnit {
    pub(crate) fn to_radians(self, angle: f64) -> f64 {
        match self {
            AngleUnit::Rad => angle,
            AngleUnit::Deg => angle.to_radians(),
        }
    }
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RobotFileConvention {
    #[default]
    Screws,
    StandardDh,
    ModifiedDh,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointTable {
    pub(crate) name: Spanned<String>,
    pub(crate) parent: Option<Spanned<String>>,
    #[serde(default = "revolute", rename = "type")]
    pub(crate) kind: JointKind,
    pub(crate) screw: Option<Spanned<ScrewTable>>,
    pub(crate) point: Option<Spanned<[f64; 3]>>,
    pub(crate) direction: Option<Spanned<[f64; 3]>>,
    pub(crate) a: Option<Spanned<f64>>,
    pub(crate) alpha: Option<Spanned<f64>>,
    pub(crate) d: Option<Spanned<f64>>,
    pub(crate) theta: Option<Spanned<f64>>,
    pub(crate) fixed: Option<Spanned<PoseTable>>,
    pub(crate) limits: Option<Spanned<[f64; 2]>>,
    pub(crate) mimic: Option<Spanned<MimicTable>>,
    pub(crate) tolerance: Option<Spanned<ToleranceTable>>,
    #[serde(default)]
    pub(crate) terms: BTreeMap<Term, Spanned<f64>>,
}

impl JointTable {
    pub(crate) fn name(&self) -> &str {
        self.name.get_ref()
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ScrewTable {
    pub(crate) v: [f64; 3],
    #[serde(default)]
    pub(crate) w: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MimicTable {
    pub(crate) joint: String,
    #[serde(default = "default_factor")]
    pub(crate) multiplier: f64,
    #[serde(default)]
    pub(crate) offset: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ToleranceTable {
    pub(crate) angle: f64,
    pub(crate) length: f64,
}

fn revolute() -> JointKind {
    JointKind::Revolute
}

fn default_factor() -> f64 {
    1.0
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PoseTable {
    pub(crate) position: Spanned<[f64; 3]>,
    pub(crate) quaternion_xyzw: Option<Spanned<[f64; 4]>>,
    pub(crate) rpy: Option<Spanned<[f64; 3]>>,
    pub(crate) rotation: Option<Spanned<[[f64; 3]; 3]>>,
}

/// A mass of a link.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MassTable {
    pub(crate) on: Spanned<String>,
    pub(crate) position: Spanned<[f64; 3]>,
    pub(crate) kg: Spanned<f64>,
}

/// A target or an instrument.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TargetTable {
    pub(crate) name: Spanned<String>,
    pub(crate) on: Option<Spanned<String>>,
    position: Spanned<[f64; 3]>,
    quaternion_xyzw: Option<Spanned<[f64; 4]>>,
    rpy: Option<Spanned<[f64; 3]>>,
    rotation: Option<Spanned<[[f64; 3]; 3]>>,
}

impl TargetTable {
    pub(crate) fn pose(&self) -> PoseTable {
        PoseTable {
            position: self.position.clone(),
            quaternion_xyzw: self.quaternion_xyzw.clone(),
            rpy: self.rpy.clone(),
            rotation: self.rotation.clone(),
        }
    }
}
