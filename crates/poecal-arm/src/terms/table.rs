//! Tables of terms, and of groups of them whose coefficients are of one size.

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::ComplexField as _;

/// Makes an enum from its table: each variant with its row.
macro_rules! table {
    ($(#[$attribute:meta])* pub enum $Name:ident: $Row:ident {
        $($(#[$doc:meta])* $variant:ident = $row:expr,)+
    }) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum $Name {
            $($(#[$doc])* $variant,)+
        }

        impl $Name {
            /// All variants, in the order of every list.
            pub const ALL: [$Name; [$(stringify!($variant)),+].len()] = [$($Name::$variant),+];

            /// Row of the table.
            #[must_use]
            pub const fn row(self) -> &'static $Row {
                match self {
                    $($Name::$variant => {
                        const ROW: $Row = $row;
                        &ROW
                    })+
                }
            }
        }
    };
}

/// Argument x of a term's function, and meaning of its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TermArgument {
    /// Nothing.
    Nothing,
    /// The joint's own value, for a compliant joint that of the joint to which it belongs (rad, m); a number is the order k of a harmonic.
    OwnValue,
    /// The moment about the joint of all masses of the model, over the largest.
    Masses,
    /// The moment about the joint of the weight of this number, over the largest.
    Weight,
    /// The value of the joint of this number, counted from the base (rad, m).
    OtherJoint,
    /// The factor of this number, from its reference.
    Factor,
    /// The factor of this number times the moment about the joint of the last weight, over the largest: a payload.
    Payload,
}

/// A function b of an argument x.
#[derive(Clone, Copy, Debug)]
pub enum TermFunction {
    /// 1.
    One,
    /// x.
    Identity,
    /// sin kx.
    Sine,
    /// cos kx.
    Cosine,
    /// Any other function, and its derivative.
    Other(fn(f64) -> [f64; 2]),
}

impl TermFunction {
    /// The function of an argument and the term's number k, and its derivative by the argument.
    #[must_use]
    pub fn evaluate(self, x: f64, k: f64) -> [f64; 2] {
        match self {
            TermFunction::One => [1.0, 0.0],
            TermFunction::Identity => [x, 1.0],
            TermFunction::Sine => [(k * x).sin(), k * (k * x).cos()],
            TermFunction::Cosine => [(k * x).cos(), -k * (k * x).sin()],
            TermFunction::Other(function) => function(x),
        }
    }
}

/// A row of the table of terms.
#[derive(Clone, Copy, Debug)]
pub struct TermRow {
    /// Name in files, before its number if it has one.
    pub name: &'static str,
    /// Function in words and signs, with q for the joint's value and `{}` for the number.
    pub formula: &'static str,
    /// Argument of its function.
    pub argument: TermArgument,
    /// Function.
    pub function: TermFunction,
    /// Standard deviation of the coefficient over robots, its prior, for a revolute joint and for a prismatic one.
    pub deviation: [f64; 2],
    /// Group among corrections: of a joint's own value, of a revolute compliant joint and of a prismatic one.
    pub groups: [Option<TermGroup>; 3],
}

impl TermRow {
    /// True if it has a number.
    #[must_use]
    pub fn is_numbered(&self) -> bool {
        self.formula.contains("{}")
    }

    /// True if its coefficient is a share of a joint's value, without unit; others are in the unit of the joint's value, rad or m.
    #[must_use]
    pub fn is_share(&self) -> bool {
        matches!(self.argument, TermArgument::OwnValue | TermArgument::OtherJoint)
            && matches!(self.function, TermFunction::Identity)
    }
}

/// 0.1°, or 0.2 mm.
const TENTH: [f64; 2] = [0.1f64.to_radians(), 2e-4];
const PERIODIC: [Option<TermGroup>; 3] = [Some(TermGroup::Harmonics), Some(TermGroup::Wobble), Some(TermGroup::Runout)];
/// 0.01°, or 0.02 mm.
const HUNDREDTH: [f64; 2] = [0.01f64.to_radians(), 2e-5];

table! {
/// A kind of terms, a row of their table. A term that is added to it is freed, corrected, read and written, predicted, exported to C and
/// inverted like the others.
///
/// ```
/// use poecal_arm::{TermArgument, TermKind};
/// let row = TermKind::Sine.row();
/// assert_eq!((row.name, row.argument, row.function.evaluate(0.0, 2.0)), ("sin", TermArgument::OwnValue, [0.0, 2.0]));
/// ```
pub enum TermKind: TermRow {
    /// Joint offset: the reading at which the joint is at zero (lou2009: Δθ). The prior is that of a remounted encoder: 5° or 20 mm.
    Offset = TermRow { name: "offset", formula: "1",
        argument: TermArgument::Nothing, function: TermFunction::One, deviation: [5f64.to_radians(), 0.02], groups: [None; 3] },
    /// Error of a gear's ratio. 0.5 %: a belt, or a tooth more or less of a gear with two hundred.
    Ratio = TermRow { name: "ratio", formula: "q",
        argument: TermArgument::OwnValue, function: TermFunction::Identity, deviation: [5e-3; 2], groups: [Some(TermGroup::Ratio), None, None] },
    /// A harmonic of the joint's value, k periods a turn: eccentric gears and encoders; for a compliant joint the wobble of its joint's
    /// bearing. 0.1° or 0.2 mm are the largest that users of encoders report.
    Sine = TermRow { name: "sin", formula: "sin({} q)",
        argument: TermArgument::OwnValue, function: TermFunction::Sine, deviation: TENTH, groups: PERIODIC },
    /// The same harmonic a quarter of a period later.
    Cosine = TermRow { name: "cos", formula: "cos({} q)",
        argument: TermArgument::OwnValue, function: TermFunction::Cosine, deviation: TENTH, groups: PERIODIC },
    /// Compliance under the robot's own weight, `Σ m z·((p - o) × ĝ)/Σ m ℓ` with the masses m at p, the axis z through o and the longest
    /// lever ℓ of each; for a prismatic joint `z·ĝ`.
    Masses = TermRow { name: "masses", formula: "the moment about the joint of the links' masses, over the largest",
        argument: TermArgument::Masses, function: TermFunction::Identity, deviation: TENTH, groups: [Some(TermGroup::Sag), Some(TermGroup::Tilt), None] },
    /// Compliance under one weight, `z·((p - o) × ĝ)/ℓ` with the weight at p, the axis z through o and the longest lever ℓ of all weights of
    /// that joint; for a prismatic joint `z·ĝ`. A weight that the joint does not carry has no moment.
    Sag = TermRow { name: "sag", formula: "the moment about the joint of weight {}, over the largest",
        argument: TermArgument::Weight, function: TermFunction::Identity, deviation: TENTH, groups: [Some(TermGroup::Sag), Some(TermGroup::Tilt), Some(TermGroup::Shift)] },
    /// Coupling: a joint that moves with another one, as in wrists with nested gears, and in parallel links. 2 %: the ratio of a last stage
    /// of gears.
    Coupled = TermRow { name: "coupled", formula: "the value of joint {}, counted from the base",
        argument: TermArgument::OtherJoint, function: TermFunction::Identity, deviation: [2e-2; 2], groups: [None; 3] },
    /// Another reading: a temperature, or half the backlash if the factor is the side from which the joint came, +1 or -1.
    Factor = TermRow { name: "factor", formula: "factor {} from its reference",
        argument: TermArgument::Factor, function: TermFunction::Identity, deviation: HUNDREDTH, groups: [Some(TermGroup::Factors), None, None] },
    /// Compliance under a payload, `f z·((p - o) × ĝ)/ℓ` with the payload f at the position p of the last weight, axis and lever as of a sag.
    /// The payload is known, so the coefficient is an angle for each kilogram at full lever.
    Payload = TermRow { name: "payload", formula: "factor {} * the moment about the joint of a unit weight at the last link, over the largest",
        argument: TermArgument::Payload, function: TermFunction::Identity, deviation: HUNDREDTH, groups: [Some(TermGroup::Payload), Some(TermGroup::Payload), None] },
}
}

/// A row of the table of groups.
#[derive(Clone, Copy, Debug)]
pub struct GroupRow {
    /// Name.
    pub name: &'static str,
    /// Unit of a thousandth of its effects, as in reports, and of its sizes.
    pub symbols: [&'static str; 2],
    /// Sizes: the usual one if it is not left out, the common one among industrial robots, and a small one; 0 leaves it out.
    pub sizes: [f64; 3],
    /// Sizes that are tried, in order; empty for a group that has the size of the one before it.
    pub tried: &'static [f64],
    /// Effect in words.
    pub effect: &'static str,
}

/// Sizes that are tried, radians or metres: from a precise robot's to those of plastic gears.
const OF_VALUES: &[f64] = &[0.0, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2];
const OF_FACTORS: &[f64] = &[0.0, 1e-6, 1e-5, 1e-4, 1e-3];
const OF_LENGTHS: &[f64] = &[0.0, 1e-5, 3e-5, 1e-4, 3e-4];
const ANGLES: [&str; 2] = ["mrad"; 2];
const LENGTHS: [&str; 2] = ["mm"; 2];

table! {
/// A group of terms whose coefficients are of one size.
pub enum TermGroup: GroupRow {
    /// Gears that are compliant about the joint's own axis under weight; radians at the largest moment.
    Sag = GroupRow { name: "sag", symbols: ANGLES, sizes: [1e-3, 1e-3, 3e-4], tried: OF_VALUES,
        effect: "{joint} sags by up to {much} under weight" },
    /// Bearings and links that are compliant across the axis under weight; radians at the largest moment.
    Tilt = GroupRow { name: "tilt", symbols: ANGLES, sizes: [1e-3, 1e-3, 3e-4], tried: &[],
        effect: "the bearing or link of {joint} tilts by up to {much} under weight" },
    /// Ratios of gears; radians each radian.
    Ratio = GroupRow { name: "ratio", symbols: ANGLES, sizes: [1e-4, 1e-4, 3e-5], tried: OF_VALUES,
        effect: "{joint} turns {much} {way} each radian than it reads" },
    /// First and second harmonic of the joint's own value; radians of amplitude.
    Harmonics = GroupRow { name: "harmonics", symbols: ANGLES, sizes: [1e-4, 1e-4, 3e-5], tried: OF_VALUES,
        effect: "gear or encoder of {joint} errs by up to {much} within a turn" },
    /// Second harmonic across the axis, and first if bearings are compliant in all directions; radians of amplitude.
    Wobble = GroupRow { name: "wobble", symbols: ANGLES, sizes: [1e-4, 0.0, 0.0], tried: OF_VALUES,
        effect: "the axis of {joint} wobbles by up to {much} within a turn" },
    /// Half the play of gears: of factors whose names begin with `approach`, radians each unit.
    Backlash = GroupRow { name: "backlash", symbols: ANGLES, sizes: [1e-4, 0.0, 0.0], tried: OF_VALUES,
        effect: "{joint} stands off by {much} to the side from which it comes" },
    /// All other factors, radians each unit.
    Factors = GroupRow { name: "factors", symbols: ANGLES, sizes: [1e-5, 0.0, 0.0], tried: OF_FACTORS,
        effect: "{joint} follows the factors by up to {much}" },
    /// Gears, bearings and links that are compliant under a payload: of the factor `payload`, radians each kilogram at full lever.
    Payload = GroupRow { name: "payload", symbols: ["mrad", "mrad/kg"], sizes: [1e-4, 0.0, 0.0], tried: OF_LENGTHS,
        effect: "{joint} deflects by up to {much} under the payload" },
    /// Bearings and links that shift under weight; metres.
    Shift = GroupRow { name: "shift", symbols: LENGTHS, sizes: [1e-4, 0.0, 0.0], tried: OF_VALUES,
        effect: "the bearing or link of {joint} shifts by up to {much} under weight" },
    /// First and second harmonic along three axes; metres of amplitude.
    Runout = GroupRow { name: "runout", symbols: LENGTHS, sizes: [3e-5, 0.0, 0.0], tried: OF_LENGTHS,
        effect: "the axis of {joint} runs out by up to {much} within a turn" },
}
}

impl TermGroup {
    /// Name.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// True if its sizes are lengths, metres; others are radians.
    #[must_use]
    pub fn is_of_lengths(self) -> bool {
        self.row().symbols == LENGTHS
    }
}
