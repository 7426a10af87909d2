"""Kinematic calibration of robot arms by the product of exponentials.

Lengths are in metres and angles in radians, unless a name ends in a unit: such a keyword takes a number in this unit, or a text with another
(``sigma_position_mm="50um"``). Poses are arrays of shape (4, 4), named ``a_from_b``.

Examples
--------
>>> import poecal
>>> robot = poecal.Robot.from_dh(a_m=[0, 0.4, 0], alpha_rad=[1.57, 0, 1.57], d_m=[0.3, 0, 0.4], theta_rad=[0, 0, 0])
>>> made = poecal.simulate(robot, kind="point", count=60)
>>> calibration = poecal.calibrate(made.nominal, made.measurements)
>>> held_out = calibration.accuracy.held_out
>>> held_out.nominal.position_mm.rms > 1 > 0.2 > held_out.calibrated.position_mm.rms
True
>>> calibration.predict([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]).shape
(2, 4, 4)
"""

from ._errors import (
    Error,
    ExportError,
    FileError,
    FormatError,
    InputError,
    KeywordError,
    MeasurementError,
    ModelError,
    OptionError,
    PackageError,
    PoecalWarning,
    ProblemError,
    RowError,
    SolverError,
    UnitError,
)
from ._findings import Findings
from ._poecal import (
    Accuracy,
    Calibration,
    Covariance,
    Measurements,
    ModelAccuracy,
    Plan,
    Prediction,
    Residuals,
    Robot,
    SetAccuracy,
    Simulation,
    Statistic,
    TestPlan,
    Verdict,
    Watch,
    calibrate,
    check,
    compare,
    export,
    guess_columns,
    hand_eye,
    identify,
    init,
    iso9283,
    offsets,
    plan,
    read_joints,
    recalibrate,
    reproduce,
    schema,
    set_limit,
    set_threads,
    simulate,
    tcp,
    track,
    version,
)
from ._results import Check, ColumnGuess, Comparison, Offsets, Validation, Visit, VisitPlan
from ._session_results import Compensation, HandEye, Identification, Iso9283, Reproduction, ToolTip, WatchedRow

__all__ = [
    "Accuracy",
    "Calibration",
    "Check",
    "ColumnGuess",
    "Comparison",
    "Compensation",
    "Covariance",
    "Error",
    "ExportError",
    "FileError",
    "Findings",
    "FormatError",
    "HandEye",
    "Identification",
    "Iso9283",
    "InputError",
    "KeywordError",
    "MeasurementError",
    "Measurements",
    "ModelAccuracy",
    "ModelError",
    "Offsets",
    "OptionError",
    "PackageError",
    "Plan",
    "PoecalWarning",
    "Prediction",
    "ProblemError",
    "Reproduction",
    "Residuals",
    "Robot",
    "RowError",
    "SetAccuracy",
    "Simulation",
    "SolverError",
    "Statistic",
    "TestPlan",
    "ToolTip",
    "UnitError",
    "Validation",
    "Verdict",
    "Visit",
    "VisitPlan",
    "Watch",
    "WatchedRow",
    "__version__",
    "calibrate",
    "check",
    "compare",
    "export",
    "guess_columns",
    "hand_eye",
    "identify",
    "init",
    "iso9283",
    "offsets",
    "plan",
    "read_joints",
    "recalibrate",
    "reproduce",
    "schema",
    "set_limit",
    "set_threads",
    "simulate",
    "tcp",
    "track",
    "version",
]

__version__: str = version()
