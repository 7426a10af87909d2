from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, Protocol, TypeAlias, final, overload

import numpy as np
import pandas  # type: ignore[import-untyped, import-not-found, unused-ignore]
import polars  # type: ignore[import-not-found, unused-ignore]
from matplotlib.axes import Axes  # type: ignore[import-not-found, unused-ignore]
from matplotlib.figure import Figure  # type: ignore[import-not-found, unused-ignore]
from numpy.typing import ArrayLike, NDArray

from ._results import Check, ColumnGuess, Comparison, Offsets, Validation, Visit, VisitPlan
from ._session_results import Compensation, HandEye, Identification, Iso9283, Reproduction, ToolTip, WatchedRow

__all__ = [
    "Accuracy",
    "Calibration",
    "Covariance",
    "Measurements",
    "ModelAccuracy",
    "Plan",
    "Prediction",
    "Residuals",
    "Robot",
    "SetAccuracy",
    "Simulation",
    "Statistic",
    "TestPlan",
    "Verdict",
    "Watch",
    "_calibration",
    "_measurements",
    "_nearest",
    "_renamed",
    "_robot",
    "_shown",
    "_write_text",
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
    "run_program",
    "schema",
    "set_limit",
    "set_threads",
    "simulate",
    "tcp",
    "track",
    "version",
]

_Path: TypeAlias = str | PathLike[str]
_Array: TypeAlias = NDArray[np.float64]
# A number in the unit that ends a keyword's name, or a text with a unit; and two of them.
_Number: TypeAlias = float | str
_Pair: TypeAlias = tuple[_Number, _Number] | str
_Kind: TypeAlias = Literal[
    "pose",
    "point",
    "mixed",
    "distance",
    "distance-change",
    "sphere",
    "socket",
    "plane",
    "height",
    "flush",
    "direction",
    "ball-bar",
    "relative",
    "component",
]
_Model: TypeAlias = Literal["delivered", "nominal", "registered", "calibrated", "corrected"]
_Frame: TypeAlias = Literal["unknown", "base"]
_End: TypeAlias = Literal["base", "tip"]
_Refit: TypeAlias = Literal["device", "tool", "auto"]
_Form: TypeAlias = Literal["urdf", "toml"]
_Level: TypeAlias = Literal["good", "inside_sampled_range", "measured_configurations", "located", "do_not_use"]
_Rows: TypeAlias = slice | int | np.integer[Any] | Sequence[int] | Sequence[bool] | NDArray[np.integer[Any]] | NDArray[np.bool_]

class _DataFrame(Protocol):
    @property
    def columns(self) -> Any: ...
    def __getitem__(self, key: Any, /) -> Any: ...

_Table: TypeAlias = _DataFrame | Mapping[str, Iterable[object]] | NDArray[np.void]

@final
class Robot:
    """A serial robot: joints with screws, and a home pose. It never changes.

    Make one by `Robot.read` (any file), `from_urdf`, `from_toml`, `from_screws` or `from_dh`. Lengths are in metres, angles in
    radians. Robots compare by value, and can be copied and pickled.
    """
    @staticmethod
    def read(
        path: _Path,
        *,
        base_link: str | None = None,
        tip_link: str | None = None,
        instruments: Mapping[str, str] | None = None,
        targets: Mapping[str, str] | None = None,
    ) -> Robot:
        """Reads a robot model of any form: URDF, MJCF, SDF, TOML, a driver's YAML, a controller's conf, or the calibrated robot of a calibration.json.

        Parameters
        ----------
        path
            The file; its extension determines the form, or else the beginning of its text.
        base_link, tip_link
            The chain of a URDF that has several.
        instruments, targets
            Names of instruments on the robot and of targets, with their links in a URDF: the robot is the tree of the joints to these.

        Returns
        -------
        Robot
            The robot.

        Raises
        ------
        FileError
            The file cannot be read.
        FormatError
            It is no valid XML, TOML or JSON.
        ModelError
            It holds no robot that can be used.
        """
    @staticmethod
    def from_urdf(
        path: _Path,
        *,
        base_link: str | None = None,
        tip_link: str | None = None,
        instruments: Mapping[str, str] | None = None,
        targets: Mapping[str, str] | None = None,
    ) -> Robot:
        """Reads a chain of a URDF file.

        Parameters
        ----------
        path
            The file.
        base_link, tip_link
            First and last link of the chain, if there are several.
        instruments, targets
            Names of instruments on the robot and of targets, with their links in a URDF: the robot is the tree of the joints to these.

        Returns
        -------
        Robot
            The robot.
        """
    @staticmethod
    def from_toml(path: _Path) -> Robot:
        """Reads a TOML model of screws or of Denavit-Hartenberg parameters.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        Robot
            The robot.
        """
    @staticmethod
    def from_text(
        text: str,
        *,
        base_link: str | None = None,
        tip_link: str | None = None,
        instruments: Mapping[str, str] | None = None,
        targets: Mapping[str, str] | None = None,
    ) -> Robot:
        """A robot model of any form from its text, as of the parameter `robot_description` of ROS.

        Parameters
        ----------
        text
            Text of a URDF, MJCF, SDF, TOML model or calibration.json.
        base_link, tip_link
            The chain of a URDF that has several.
        instruments, targets
            Names of instruments on the robot and of targets, with their links in a URDF: the robot is the tree of the joints to these.

        Returns
        -------
        Robot
            The robot; its `path` is "text", by which errors name places too.
        """
    @staticmethod
    def from_screws(
        screws: ArrayLike,
        home: ArrayLike,
        *,
        names: Sequence[str] | None = None,
        limits: ArrayLike | None = None,
        angular_first: bool = False,
        name: str = "robot",
        base_link: str = "base",
        tip_link: str = "tip",
    ) -> Robot:
        """A robot of screws in the base frame at zero joint values.

        Parameters
        ----------
        screws
            Array of shape (n, 6), a unit twist for each joint: linear part v (metres), then angular part w, with |w| = 1 and v·w = 0; a sliding joint
            has w = 0 and |v| = 1.
        home
            Pose of the tip in the base at zero joint values, shape (4, 4).
        names
            n names of the joints, default joint1, joint2, …
        limits
            Array of shape (n, 2), radians or metres; rows of NaN, masked or infinite numbers are joints without limits.
        angular_first
            True if the angular part comes first.
        name, base_link, tip_link
            Names of the robot and of its first and last frame.

        Returns
        -------
        Robot
            The robot.
        """
    @staticmethod
    def from_dh(
        *,
        a_m: ArrayLike,
        alpha_rad: ArrayLike,
        d_m: ArrayLike,
        theta_rad: ArrayLike,
        convention: Literal["standard", "modified"] = "standard",
        kinds: Sequence[Literal["revolute", "prismatic"]] | None = None,
        names: Sequence[str] | None = None,
        limits: ArrayLike | None = None,
        base: ArrayLike | None = None,
        tool: ArrayLike | None = None,
        name: str = "robot",
        base_link: str = "base",
        tip_link: str = "tip",
    ) -> Robot:
        """A robot of Denavit-Hartenberg parameters.

        Parameters
        ----------
        a_m, alpha_rad, d_m, theta_rad
            Arrays of shape (n,): link length, link twist, link offset and joint angle at zero reading. A revolute joint's reading adds to
            theta, a prismatic one's to d.
        convention
            "standard" (Rz Tz Tx Rx) or "modified" (Craig: Rx Tx Rz Tz, with a and alpha of the same row).
        kinds
            "revolute" or "prismatic" for each joint, default all revolute.
        names
            n names of the joints, default joint1, joint2, …
        limits
            Array of shape (n, 2), radians or metres; rows of NaN, masked or infinite numbers are joints without limits.
        base, tool
            Pose of the first frame in the base, and of the tip in the last frame, shape (4, 4) each; default the identity.
        name, base_link, tip_link
            Names of the robot and of its first and last frame.

        Returns
        -------
        Robot
            The robot.
        """
    def forward_kinematics(self, joints: ArrayLike, *, target: str | None = None) -> _Array:
        """Poses of the tip, or of a target of the model, in the base frame.

        Parameters
        ----------
        joints
            Configurations, shape (m, n), radians and metres, in the order of `reading_names`; or one, shape (n,).
        target
            Name of a target of the model, default the tip.

        Returns
        -------
        numpy.ndarray
            Poses of shape (m, 4, 4), or (4, 4) for one configuration.
        """
    def joint_poses(self, joints: ArrayLike) -> _Array:
        """Frames of the joints in the base frame, as a drawing of the robot needs them.

        Parameters
        ----------
        joints
            Configurations, as for `forward_kinematics`.

        Returns
        -------
        numpy.ndarray
            Poses of shape (m, n, 4, 4), or (n, 4, 4) for one configuration.
        """
    @property
    def name(self) -> str:
        """The robot's name."""
    @property
    def base_link(self) -> str:
        """Name of the base frame."""
    @property
    def tip_link(self) -> str:
        """Name of the tip frame."""
    @property
    def path(self) -> str:
        """The file from which it was read, as it was named; for robots of arrays their name."""
    @property
    def joint_names(self) -> list[str]:
        """Names of the n moving joints from base to tip."""
    def with_factors(self, names: Sequence[str]) -> Robot:
        """The same robot with further columns of the measurements on which terms of its joints may depend, like temperature.

        "approach" or "approach_JOINT" states from which side joints came, 1 or -1, "payload" the mass at the tip, in kg. They are readings behind
        those of the joints.

        Parameters
        ----------
        names
            Names of the columns.

        Returns
        -------
        Robot
            The robot.
        """
    @property
    def reading_names(self) -> list[str]:
        """Names of the readings that a configuration consists of: those of the joints except mimic joints, which follow another."""
    @property
    def kinds(self) -> list[Literal["revolute", "prismatic"]]:
        """"revolute" or "prismatic" for each joint."""
    @property
    def screws(self) -> _Array:
        """Screws in the base frame at zero joint values, shape (n, 6): linear part (metres), then angular part."""
    @property
    def joint_frames(self) -> _Array:
        """Frames of the joints in the base at zero joint values, shape (n, 4, 4)."""
    @property
    def limits(self) -> _Array:
        """Lower and upper limits, shape (n, 2), radians or metres; infinite for a joint without limits."""
    @property
    def home(self) -> _Array:
        """Pose of the tip in the base at zero joint values, shape (4, 4)."""
    @property
    def targets(self) -> dict[str, _Array]:
        """Poses of the model's targets in the tip frame, by name, shape (4, 4) each."""
    def to_text(self, format: _Form) -> str:
        """The model as a text.

        Parameters
        ----------
        format
            "urdf" (a new one, of links, joints and a tip) or "toml" (a table of screws).

        Returns
        -------
        str
            The text.
        """
    def write(self, path: _Path, *, format: _Form | None = None, force: bool = False) -> None:
        """Writes the model to a file.

        Parameters
        ----------
        path
            The file.
        format
            "urdf" or "toml", by default from the extension.
        force
            True to overwrite a file that exists.
        """
    def _repr_html_(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __copy__(self) -> Robot: ...
    def __deepcopy__(self, memo: dict[int, Any], /) -> Robot: ...
    def __reduce__(self) -> tuple[Callable[[bytes], Robot], tuple[bytes]]: ...
    __hash__: None  # type: ignore[assignment]

@final
class Measurements:
    """Measurements of a robot: in each row a configuration and the measurement of a target. Immutable.

    Make them by `Measurements.from_csv`, `from_arrays` or `from_dataframe`. Lengths are in metres, angles in radians. Measurements
    compare by value, and can be copied and pickled.
    """
    @staticmethod
    def from_csv(
        paths: _Path | Sequence[_Path],
        robot: Robot,
        *,
        columns: _Path | None = None,
        train_where: str | None = None,
        ignore_sets: bool = False,
        strict: bool = False,
        device_frames: Literal["common", "per-file"] = "common",
        join: Literal["name", "rows", "time"] | None = None,
        lag: str | None = None,
        units: str | None = None,
        sheet: str | None = None,
        body: str | None = None,
        topics: Sequence[str] | None = None,
        socket_distance: str | None = None,
        contact: Literal["point", "flush"] = "point",
        instrument_noise: Sequence[str] | None = None,
        cameras: Sequence[str] | None = None,
        markers: Sequence[str] | None = None,
    ) -> Measurements:
        """Reads measurement files, joined in their order.

        Parameters
        ----------
        paths
            A file, or several.
        robot
            The robot whose joints the columns name.
        columns
            A mapping file for files with other column names.
        train_where
            "COLUMN=VALUE[,VALUE]": fit only rows whose column has one of these values, and hold out all others.
        ignore_sets
            True to ignore the files' column `set`, as for rows that judge a calibration.
        strict
            True to treat beam breaks (empty or zero positions) as an error instead of skipping them with a warning.
        device_frames
            Rows that share a frame of the measuring device: "common", all (or those of one name in the column `instrument`), or "per-file", those of
            a file.
        join
            Rule by which joint readings and measurements in two files are joined: "name", "rows" or "time". By default by name, else recordings at
            the times of their static intervals, and lists by their order, if the nominal robot agrees with no other one as well.
        lag
            Lag of the clocks of two recordings, the measurements' time less that of the joint readings, "12s+-2s"; by default it is estimated.
        units
            Units of columns that state none, "mm,deg"; a mapping file takes precedence.
        sheet
            Sheet of workbooks; by default the only one that holds a table.
        body
            Body, marker or tool of recordings of a camera system; by default the only one that moves.
        topics
            Topics of ROS 2 bags (MCAP); by default the only ones of joint readings and of measurements.
        socket_distance
            Known distance between the two sockets of each place, "50mm", or of pairs by name, "A-B=50mm,B-C=70mm+-0.02mm".
        contact
            Kind of contact for rows whose `contact` cell is empty: "point" or "flush".
        instrument_noise
            Noise of instruments that grows with the distance, like "tracker:10um+5um/m": a standard deviation in all directions, and one
            across the line of sight for each metre; of all instruments without a name. For rows that state none.
        cameras
            Files of the cameras that saw corners in pixels: CSV (FILE#VERSION if it has several), YAML of OpenCV, ROS, Kalibr or
            industrial_calibration, XML of ViSP.
        markers
            Boards or solids that they saw: CSV files of points, "chessboard:10x7:27mm", or files of Kalibr, industrial_calibration or OpenCV.

        Returns
        -------
        Measurements
            The rows of all files.

        Raises
        ------
        FileError
            A file cannot be read.
        MeasurementError
            It holds no measurements of this robot; the error states the line and the column.
        """
    @staticmethod
    def from_files(paths: _Path | Sequence[_Path], robot: Robot, **options: Any) -> Measurements:
        """Reads files of instruments, controllers and recorders in their own forms: the same files and options as `from_csv`, under a clearer name.

        Parameters
        ----------
        paths
            A file, or several; with joint readings in one and measurements in another they are joined. Bags of ROS 2 may be in MCAP or in SQLite
            (`.db3`), which the program does not read. Bags of ROS 1 are converted to MCAP with `rosbags-convert`.
        robot
            The robot whose joints the columns name.

        Returns
        -------
        Measurements
            The rows of all files.

        Raises
        ------
        FileError
            A file cannot be read.
        MeasurementError
            It holds no measurements of this robot; the error states the line and the column.
        """
    @staticmethod
    def from_contents(contents: Mapping[str, str | bytes], robot: Robot, **options: Any) -> Measurements:
        """Reads files from their contents, as from a database or an upload: the same files and options as `from_files`.

        Parameters
        ----------
        contents
            Names of the files, whose extensions count, with their contents as text or bytes: ``{"points.csv": text}``. A bag in SQLite (`.db3`) is
            read as a file only.
        robot
            The robot whose joints the columns name.

        Returns
        -------
        Measurements
            The rows of all files.

        Raises
        ------
        MeasurementError
            They hold no measurements of this robot; the error states the line and the column.
        """
    @staticmethod
    def from_arrays(
        robot: Robot,
        *,
        joints: ArrayLike,
        positions: ArrayLike | None = None,
        quaternions_xyzw: ArrayLike | None = None,
        poses: ArrayLike | None = None,
        targets: Sequence[str] | None = None,
        instruments: Sequence[str] | None = None,
        sets: Sequence[Literal["fit", "held_out"] | None] | None = None,
        ids: Sequence[str] | None = None,
        sigma_position_mm: ArrayLike | None = None,
        sigma_rotation_deg: ArrayLike | None = None,
        angle_unit: str = "rad",
        length_unit: str = "m",
    ) -> Measurements:
        """Measurements from arrays: positions, with orientations or without, or poses.

        Arrays may be read-only and of any layout. Masked numbers count as NaN. If the whole row is masked, they are a missing orientation or standard
        deviation; otherwise they are refused.

        Parameters
        ----------
        robot
            The robot that was measured.
        joints
            Readings, shape (m, n), in the order of `robot.reading_names`: in `angle_unit`, of sliding joints in `length_unit`.
        positions
            Positions of the target in the device's frame, shape (m, 3), in `length_unit`.
        quaternions_xyzw
            Orientations beside `positions` as unit quaternions x, y, z, w, shape (m, 4); rows of NaN are points without orientation.
        poses
            Poses device_from_target instead of `positions`, shape (m, 4, 4), translations in `length_unit`.
        targets
            m names of targets, default the tip itself.
        instruments
            m names of measuring devices, each with a frame of its own.
        sets
            "fit", "held_out" or None (unstated) for each row.
        ids
            m names of the rows.
        sigma_position_mm, sigma_rotation_deg
            Standard deviations of each measured component, if rows state them: a number, or shape (m,), NaN for a row without one.
        angle_unit, length_unit
            "rad", "deg", …; "m", "mm", …

        Returns
        -------
        Measurements
            m rows.
        """
    @staticmethod
    def from_dataframe(
        frame: _Table,
        robot: Robot,
        *,
        columns: _Path | None = None,
        train_where: str | None = None,
        ignore_sets: bool = False,
        strict: bool = False,
        units: str | None = None,
        socket_distance: str | None = None,
        contact: Literal["point", "flush"] = "point",
        instrument_noise: Sequence[str] | None = None,
        cameras: Sequence[str] | None = None,
        markers: Sequence[str] | None = None,
    ) -> Measurements:
        """Measurements from a table in memory: a data frame of pandas or polars, a dict of columns, or a structured array of NumPy.

        Columns have the same names, units in brackets and meanings as those of a file, `x[mm]` or `target`. Missing and masked values are
        empty cells.

        Parameters
        ----------
        frame
            The table: anything with `columns` and columns by name, a dict of columns of one length, or an array with named fields.
        robot
            The robot whose joints the columns name.
        columns
            A mapping file for a table with other column names.
        train_where
            "COLUMN=VALUE[,VALUE]": fit only rows whose column has one of these values, and hold out all others.
        ignore_sets
            True to ignore the column `set`, as for rows that judge a calibration.
        strict
            True to treat beam breaks (empty or zero positions) as an error instead of skipping them with a warning.
        units
            Units of columns that state none, "mm,deg"; a mapping file takes precedence.
        socket_distance
            Known distance between the two sockets of each place, "50mm", or of pairs by name, "A-B=50mm,B-C=70mm+-0.02mm".
        contact
            Kind of contact for rows whose `contact` cell is empty: "point" or "flush".
        instrument_noise
            Noise of instruments that grows with the distance, like "tracker:10um+5um/m": a standard deviation in all directions, and one
            across the line of sight for each metre; of all instruments without a name. For rows that state none.
        cameras
            Files of the cameras that saw corners in pixels: CSV (FILE#VERSION if it has several), YAML of OpenCV, ROS, Kalibr or
            industrial_calibration, XML of ViSP.
        markers
            Boards or solids that they saw: CSV files of points, "chessboard:10x7:27mm", or files of Kalibr, industrial_calibration or OpenCV.

        Returns
        -------
        Measurements
            The rows of the table.

        Raises
        ------
        MeasurementError
            The table holds no measurements of this robot; the error states the row.
        """
    @staticmethod
    def join(parts: Sequence[Measurements]) -> Measurements:
        """Rows of several measurements of one robot, in sequence; `a + b` joins two.

        Rows keep their attributes: target, instrument, set, id, standard deviations, file and line. Targets of one name are one target. Rows of
        instruments of one name, and all rows that name none, share a frame of the measuring device: name the instruments if it was moved in between.

        Parameters
        ----------
        parts
            Measurements of the same joints.

        Returns
        -------
        Measurements
            The rows of all parts.
        """
    @property
    def reading_names(self) -> list[str]:
        """Names of the readings that a configuration consists of."""
    @property
    def joints(self) -> _Array:
        """Readings, shape (m, n), radians and metres."""
    @property
    def positions(self) -> _Array:
        """Measured positions in the device's frame, shape (m, 3), metres."""
    @property
    def poses(self) -> _Array:
        """Measured poses device_from_target, shape (m, 4, 4); with the identity if a row has no orientation (`has_orientation`)."""
    @property
    def has_orientation(self) -> NDArray[np.bool_]:
        """Rows with a measured orientation, shape (m,): True if it was measured."""
    @property
    def targets(self) -> list[str | None]:
        """The target of each row; None for the tip itself."""
    @property
    def instruments(self) -> list[str | None]:
        """The instrument, or its station, that measured each row; None if there is one without a name."""
    @property
    def sets(self) -> list[Literal["fit", "held_out"] | None]:
        """"fit", "held_out", or None, for each row."""
    @property
    def ids(self) -> list[str]:
        """The rows' ids; empty if they have none."""
    @property
    def files(self) -> list[str]:
        """The files of the rows, as they were named."""
    @property
    def notes(self) -> list[str]:
        """Findings in the files, such as the position of a camera, a sentence each."""
    @property
    def warnings(self) -> list[str]:
        """Warnings about the files, a sentence each."""
    def _repr_html_(self) -> str: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: _Rows, /) -> Measurements: ...
    def __iter__(self) -> Iterator[Measurements]: ...
    def __add__(self, other: Measurements, /) -> Measurements: ...
    def __radd__(self, other: Measurements, /) -> Measurements: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __copy__(self) -> Measurements: ...
    def __deepcopy__(self, memo: dict[int, Any], /) -> Measurements: ...
    def __reduce__(self) -> tuple[Callable[[bytes], Measurements], tuple[bytes]]: ...
    __hash__: None  # type: ignore[assignment]

@final
class Statistic:
    """Mean, root mean square, 95th percentile and maximum of errors."""
    @property
    def mean(self) -> float:
        """Mean."""
    @property
    def rms(self) -> float:
        """Root mean square."""
    @property
    def p95(self) -> float:
        """95th percentile."""
    @property
    def max(self) -> float:
        """Largest."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class ModelAccuracy:
    """Errors of one model on one set of rows."""
    @property
    def position_mm(self) -> Statistic:
        """Distance from measured to predicted position, millimetres."""
    @property
    def rotation_deg(self) -> Statistic | None:
        """Angle from measured to predicted orientation, degrees; None if no orientation was measured."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class SetAccuracy:
    """Errors of the nominal, registered, calibrated and corrected model on one set of rows."""
    @property
    def count(self) -> int:
        """Number of measurements."""
    @property
    def nominal(self) -> ModelAccuracy:
        """The nominal model; only an unknown device frame is fitted."""
    @property
    def registered(self) -> ModelAccuracy:
        """Device frame and targets fitted, screws nominal."""
    @property
    def calibrated(self) -> ModelAccuracy:
        """Screws fitted too."""
    @property
    def corrected(self) -> ModelAccuracy | None:
        """Screws and terms of the joints fitted together; None if no terms were requested."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Accuracy:
    """Errors on the rows that were fitted and on those that were held out."""
    @property
    def training(self) -> SetAccuracy:
        """Errors on the rows that were fitted."""
    @property
    def held_out(self) -> SetAccuracy | None:
        """Errors on the rows that were not fitted; None if none was held out."""
    @property
    def few_configurations(self) -> int | None:
        """Number of configurations if all were fitted because too few would have been held out; None otherwise."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Verdict:
    """Verdict: permitted use of a calibration, and the reasons against a wider one."""
    @property
    def level(self) -> _Level:
        """"good", "inside_sampled_range", "measured_configurations", "located" or "do_not_use"."""
    @property
    def reasons(self) -> list[str]:
        """Sentences with the deciding figures."""
    @property
    def model(self) -> str | None:
        """The delivered model: "corrected" if it has terms, else "calibrated"."""
    @property
    def expected_error_mm(self) -> float | None:
        """Expected error of that model in configurations like those that were measured, millimetres (RMS); None if no use is advised."""
    @property
    def bound95_mm(self) -> float | None:
        """The distance that 95 % of its errors do not exceed there, millimetres."""
    @property
    def sampled_range_error_mm(self) -> float | None:
        """Expected error of that model anywhere inside the sampled range of each joint, millimetres (RMS)."""
    @property
    def nominal_error_mm(self) -> float | None:
        """Distance of the nominal model's predictions from its own there, with targets and devices fitted, millimetres (RMS)."""
    @property
    def gain(self) -> str | None:
        """Comparison with the nominal model's predictions there: "clear", "unclear" or "loss"."""
    @property
    def confirmed(self) -> str | None:
        """Sentence with figures if the axes of the nominal model are confirmed; None if they are not."""
    def is_at_least(self, level: _Level) -> bool:
        """True if a calibration may be used at least to this level.

        Parameters
        ----------
        level
            "good", "inside_sampled_range", "measured_configurations", "located" or "do_not_use".

        Returns
        -------
        bool
            True if the verdict's level is `level` or a better one.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Prediction:
    """Predicted poses of m configurations, and the expected error of each."""
    @property
    def target(self) -> str | None:
        """Name of the target that was predicted; None for the tip."""
    @property
    def poses(self) -> _Array:
        """The poses, shape (m, 4, 4), metres."""
    @property
    def sigma_position_m(self) -> _Array:
        """Expected root mean square distance, shape (m,), metres."""
    @property
    def sigma_rotation_rad(self) -> _Array:
        """Expected root mean square angle, shape (m,), radians."""
    @property
    def bound95_position_m(self) -> _Array:
        """Distance that is not exceeded in 95 % of all cases, shape (m,), metres."""
    @property
    def inside_sampled_range(self) -> NDArray[np.bool_]:
        """Configurations inside the sampled range, shape (m,): True if every joint is inside its range."""
    def __len__(self) -> int: ...

@final
class Residuals:
    """Residuals and diagnostics of each row, fitted or held out, in the order of the measurements.

    Residuals are measured minus predicted, in the measuring device's axes; errors of a model are their lengths. `len` is the number of rows.
    """
    @property
    def files(self) -> list[str | None]:
        """File of each row; None if it came from memory."""
    @property
    def lines(self) -> NDArray[np.uint32]:
        """Line of each row in its file, from 1, shape (m,); 0 if it came from memory."""
    @property
    def ids(self) -> list[str | None]:
        """Id of each row; None if it has none."""
    @property
    def held_out(self) -> NDArray[np.bool_]:
        """Held-out rows, shape (m,): True if the row was held out."""
    @property
    def targets(self) -> list[str | None]:
        """Target of each row; None for the tip itself."""
    @property
    def instruments(self) -> list[str | None]:
        """Instrument of each row; None if there is only one."""
    @property
    def position_mm(self) -> _Array:
        """Residual of position of the delivered model by component, shape (m, 3), millimetres; NaN if no position was measured."""
    @property
    def rotation_deg(self) -> _Array:
        """Residual of rotation of the delivered model by component, shape (m, 3), degrees; NaN if no orientation was measured."""
    @property
    def position_nominal_mm(self) -> _Array:
        """Error of position of the nominal model, shape (m,), millimetres; NaN if no position was measured."""
    @property
    def position_registered_mm(self) -> _Array:
        """Error of position of the registered model, shape (m,), millimetres; NaN if no position was measured."""
    @property
    def position_calibrated_mm(self) -> _Array:
        """Error of position of the calibrated model, shape (m,), millimetres; NaN if no position was measured."""
    @property
    def position_corrected_mm(self) -> _Array:
        """Error of position of the corrected model, shape (m,), millimetres; NaN without such a model, or if no position was measured."""
    @property
    def rotation_nominal_deg(self) -> _Array:
        """Error of rotation of the nominal model, shape (m,), degrees; NaN if no orientation was measured."""
    @property
    def rotation_registered_deg(self) -> _Array:
        """Error of rotation of the registered model, shape (m,), degrees; NaN if no orientation was measured."""
    @property
    def rotation_calibrated_deg(self) -> _Array:
        """Error of rotation of the calibrated model, shape (m,), degrees; NaN if no orientation was measured."""
    @property
    def rotation_corrected_deg(self) -> _Array:
        """Error of rotation of the corrected model, shape (m,), degrees; NaN without such a model, or if no orientation was measured."""
    @property
    def model(self) -> Literal["corrected", "calibrated"]:
        """The delivered model: "corrected" if it has terms, else "calibrated"."""
    @property
    def quantities(self) -> dict[str, str]:
        """Quantities that some row measured, such as "position", with their units; first the one that judges the calibration."""
    def components(self, quantity: str) -> _Array:
        """Residual of any quantity of the delivered model by component.

        Parameters
        ----------
        quantity
            Its name, as in `quantities`.

        Returns
        -------
        numpy.ndarray
            Shape (m, n), millimetres or degrees; NaN if it was not measured.
        """
    def errors(self, quantity: str, *, model: _Model = "delivered") -> _Array:
        """Error of any quantity of a model.

        Parameters
        ----------
        quantity
            Its name, as in `quantities`.
        model
            "delivered", "nominal", "registered", "calibrated", or "corrected": NaN without such a model.

        Returns
        -------
        numpy.ndarray
            Shape (m,), millimetres or degrees; NaN if it was not measured.
        """
    def corners_px(self, *, model: _Model = "delivered") -> _Array:
        """Root mean square distance of the corners of each picture from a model's predicted positions.

        Parameters
        ----------
        model
            "delivered", "nominal", "registered", "calibrated", or "corrected": NaN without such a model.

        Returns
        -------
        numpy.ndarray
            Shape (m,), pixels; NaN for rows that are no pictures.
        """
    @property
    def weight(self) -> _Array:
        """Weight of each row in the fit, shape (m,); for a held-out row the weight that it would have had."""
    @property
    def leverage(self) -> _Array:
        """Leverage of each row, shape (m,): its influence on its own prediction."""
    @property
    def studentized(self) -> _Array:
        """Studentised residual of each row, shape (m,): its length over its own standard deviation."""
    @property
    def suspected(self) -> NDArray[np.bool_]:
        """Suspected rows, shape (m,): True if the row is suspected of a gross error."""
    def to_dict(self) -> dict[str, Any]:
        """The columns of residuals.csv by their names there, with the readings of each row.

        Returns
        -------
        dict
            Arrays of shape (m,), and lists of names.
        """
    def to_dataframe(self) -> pandas.DataFrame:
        """The columns of residuals.csv as a data frame of pandas, which has to be installed.

        Returns
        -------
        pandas.DataFrame
            A line for each row.
        """
    def to_polars(self) -> polars.DataFrame:
        """The columns of residuals.csv as a data frame of polars, which has to be installed.

        Returns
        -------
        polars.DataFrame
            A line for each row.
        """
    def __len__(self) -> int: ...

@final
class Covariance:
    """Covariance of the unknowns of a calibration: shifts and turns of each joint's axis, and of each target.

    It is the one that `Calibration.predict` uses inside the sampled range (docs/theory.md §9 (39)), with the prior in it, which bounds what
    the measurements do not determine. With an unknown frame of the measuring device, axes and targets are relative to the device.
    """
    @property
    def names(self) -> list[str]:
        """Name of each of the k unknowns: a block and a motion, as "joint1.axis.x" or "target.rz".

        A revolute joint has shifts x and y along and turns rx and ry about the axes of its frame in `axes`, a prismatic one turns; a target
        has shifts along its own axes, and turns about them if its orientation was measured.
        """
    @property
    def units(self) -> list[Literal["m", "rad"]]:
        """Unit of each unknown, "m" or "rad"."""
    @property
    def matrix(self) -> _Array:
        """The covariance, shape (k, k), in products of `units`."""
    @property
    def sigma(self) -> _Array:
        """Standard deviation of each unknown, shape (k,), in `units`."""
    @property
    def axes(self) -> _Array:
        """Frames base_from_axis at zero joint values, z along the joint, shape (n, 4, 4)."""
    def __len__(self) -> int: ...

@final
class Calibration:
    """A calibration: the calibrated robot, its errors on fitted and held-out rows, and the verdict on its trustworthiness.

    `calibrate` makes one, `Calibration.read` reads one from a file. Its parts are those of `calibration.json`,
    converted on demand.
    """
    @staticmethod
    def read(path: _Path, *, residuals: _Path | None = None) -> Calibration:
        """Reads a calibration.json, and the residuals.csv beside it if there is one.

        Parameters
        ----------
        path
            The calibration.json.
        residuals
            Another residuals.csv.

        Returns
        -------
        Calibration
            The calibration, with the same behaviour as before it was written.
        """
    @property
    def robot(self) -> Robot:
        """The calibrated robot, with the targets in its tip frame."""
    @property
    def corrected_robot(self) -> Robot | None:
        """The corrected robot, with compliant joints and terms beside its joints; None if no terms were requested."""
    @property
    def corrected(self) -> dict[str, Any] | None:
        """Screws and terms of the joints, fitted together: `corrected` of calibration.json; None if no terms were requested."""
    @property
    def nominal(self) -> Robot:
        """The nominal robot."""
    @property
    def accuracy(self) -> Accuracy:
        """Errors of the nominal, registered, calibrated and corrected model on fitted and held-out rows."""
    @property
    def verdict(self) -> Verdict:
        """Permitted use of the calibration, and the reasons against a wider one; an error for a file that does not state it."""
    @property
    def acceptance(self) -> dict[str, Any] | None:
        """Result of the requested acceptance limits: `acceptance` of calibration.json; None if none were requested."""
    @property
    def record(self) -> dict[str, str]:
        """Statements about the session: a dict of texts."""
    @property
    def converged(self) -> bool:
        """True if the fit reached an optimum."""
    @property
    def warnings(self) -> list[str]:
        """Warnings, and mistakes in the input, a sentence each."""
    @property
    def library_seconds(self) -> float | None:
        """Seconds that the library took for the fit; None if it was read. Further time of a call is Python's."""
    @property
    def base_from_device(self) -> _Array:
        """Pose of the measuring device in the base, shape (4, 4)."""
    @property
    def stations(self) -> list[dict[str, Any]]:
        """Frames of the instruments: `stations` of calibration.json; empty if no row names one."""
    @property
    def corrections(self) -> list[dict[str, Any]]:
        """Each joint's correction, its uncertainty and its effect: `corrections` of calibration.json."""
    @property
    def compensation(self) -> dict[str, Any] | None:
        """Errors of programs for the nominal robot over the workspace, and the corrections that remove them.

        `compensation` of calibration.json; None if the calibration is not to be used.
        """
    @property
    def uncertainty(self) -> dict[str, Any] | None:
        """Expected errors of predictions: `uncertainty` of calibration.json; None if there are no more residuals than unknowns."""
    @property
    def identifiability(self) -> dict[str, Any]:
        """Unknowns that the measurements determine: `identifiability` of calibration.json."""
    @property
    def residuals(self) -> Residuals:
        """Residuals of each row, fitted or held out; an error if the calibration was read without its residuals.csv."""
    @property
    def covariance(self) -> Covariance:
        """Covariance of the unknowns; an error if there are no more residuals than unknowns."""
    def plot(self, axes: Sequence[Axes] | NDArray[Any] | None = None) -> Figure:
        """Draws the errors before and after, and those of each row: of position, if it was measured. Needs matplotlib.

        Parameters
        ----------
        axes
            Two axes of matplotlib to draw into, default those of a new figure.

        Returns
        -------
        matplotlib.figure.Figure
            The figure, which is not shown: notebooks show it, `savefig` writes it.
        """
    def to_dict(self) -> dict[str, Any]:
        """The whole calibration.json as dicts and lists.

        Returns
        -------
        dict
            The contents.
        """
    def to_json(self) -> str:
        """The calibration.json as a text.

        Returns
        -------
        str
            The text.
        """
    def residuals_csv(self) -> str:
        """The residuals.csv as a text.

        Returns
        -------
        str
            The text.
        """
    def write(self, folder: _Path, *, force: bool = False, report: bool | _Path = True) -> list[str]:
        """Writes the results to a folder, as the program does: calibration.json, the calibrated model, residuals.csv and report.html.

        All is written or nothing, and the models are read back and compared with the fit.

        Parameters
        ----------
        folder
            The folder.
        force
            True to overwrite files that exist.
        report
            True to write the report too, or the path of another file for it.

        Returns
        -------
        list of str
            Names of the files.

        Raises
        ------
        FileError
            The folder exists, and `force` is not set.
        ExportError
            Written files did not reproduce the fitted model.
        """
    def export(
        self,
        format: Literal[
            "urdf", "toml", "poe", "dh", "mdh", "hayati", "origins", "ur", "xarm", "franka", "pal", "lerobot", "mjcf", "sdf", "usd", "csv", "offsets"
        ],
        *,
        model: Literal["calibrated", "corrected"] = "calibrated",
        hash: str | None = None,
        motors: str | None = None,
    ) -> str:
        """The calibrated robot in the form of a controller, a driver or a simulator, read back and compared on 1,000 configurations.

        Parameters
        ----------
        format
            "urdf" (the one that was calibrated, with other numbers), "toml", "poe", "dh", "mdh", "hayati", "origins", "ur", "xarm", "franka",
            "pal", "lerobot", "mjcf", "sdf", "usd", "csv", "offsets", "tf" or "c".
        model
            "calibrated", geometry alone, or "corrected", whose terms of the joints a form of geometry leaves out, with a warning.
        hash
            The controller's checksum, for "ur".
        motors
            The text of LeRobot's existing calibration of motors, for "lerobot".

        Returns
        -------
        str
            The text. A warning names the properties that the form cannot hold.

        Raises
        ------
        ExportError
            The form cannot hold this robot.
        """
    def to_urdf(self) -> str:
        """The URDF that was calibrated, with the calibrated numbers; a new one if the model was no URDF.

        Returns
        -------
        str
            The text.
        """
    def report(self, path: _Path, *, record: Mapping[str, str] | None = None, force: bool = False) -> None:
        """Writes the report, one HTML file.

        Parameters
        ----------
        path
            The file.
        record
            Statements beside and in place of the calibration's record, as {"serial": "4711"}.
        force
            True to overwrite a file that is no report of poecal.
        """
    def certificate(
        self,
        path: _Path,
        *,
        logo: _Path | None = None,
        record: Mapping[str, str] | None = None,
        force: bool = False,
    ) -> None:
        """Writes the certificate, one page of paper (HTML).

        Parameters
        ----------
        path
            The file.
        logo
            Picture for its head: PNG, JPEG or SVG.
        record
            Statements beside and in place of the calibration's record, as {"serial": "4711"} or {"valid_until": "2027-11-28"}.
        force
            True to overwrite a file that is not poecal's.
        """
    @overload
    def predict(
        self,
        joints: ArrayLike,
        *,
        with_uncertainty: Literal[False] = False,
        output_frame: Literal["base", "device"] = "base",
        target: str | None = None,
        model: Literal["corrected", "calibrated"] = "corrected",
        readings: Literal["model", "controller"] | None = None,
    ) -> _Array:
        """Poses of the tip, or of a target.

        Parameters
        ----------
        joints
            Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`; or one, shape (n,).
        with_uncertainty
            True to return the expected error of each pose too.
        output_frame
            Frame of the poses: "base" or "device".
        target
            Name of a target, or "tip"; default the tip, with `with_uncertainty` the first target that was measured.
        model
            Model that predicts: "corrected", if there is one, or "calibrated", geometry alone.
        readings
            Meaning of the arrays: "model", readings of the model, or "controller", the controller's counts, by the calibration's mapping; required if
            these differ.

        Returns
        -------
        numpy.ndarray or Prediction
            Poses of shape (m, 4, 4), or (4, 4) for one configuration; with `with_uncertainty` a `Prediction`, always of m poses.
        """
    @overload
    def predict(
        self,
        joints: ArrayLike,
        *,
        with_uncertainty: Literal[True],
        output_frame: Literal["base", "device"] = "base",
        target: str | None = None,
        model: Literal["corrected", "calibrated"] = "corrected",
        readings: Literal["model", "controller"] | None = None,
    ) -> Prediction: ...
    @overload
    def predict(
        self,
        joints: ArrayLike,
        *,
        with_uncertainty: bool,
        output_frame: Literal["base", "device"] = "base",
        target: str | None = None,
        model: Literal["corrected", "calibrated"] = "corrected",
        readings: Literal["model", "controller"] | None = None,
    ) -> _Array | Prediction: ...
    def forward_kinematics(
        self,
        joints: ArrayLike,
        *,
        factors: Mapping[str, float] | None = None,
        model: Literal["corrected", "calibrated"] = "corrected",
        readings: Literal["model", "controller"] | None = None,
    ) -> _Array:
        """Poses of the tip in the base, by all threads: those of `predict`, at chosen values of factors.

        Parameters
        ----------
        joints
            Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
        factors
            Values of the corrected model's factors by their names, default their references.
        model
            Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
        readings
            Meaning of the arrays: "model", readings of the model, or "controller", the controller's counts, by the calibration's mapping; required if
            these differ.

        Returns
        -------
        numpy.ndarray
            Poses of shape (m, 4, 4), or (4, 4) for one configuration.
        """
    def jacobian(
        self,
        joints: ArrayLike,
        *,
        factors: Mapping[str, float] | None = None,
        model: Literal["corrected", "calibrated"] = "corrected",
    ) -> _Array:
        """Motion of the tip with each reading: of its point, then its turn, in the axes of the base, deflection under weights included.

        Parameters
        ----------
        joints
            Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
        factors
            Values of the corrected model's factors by their names, default their references.
        model
            Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.

        Returns
        -------
        numpy.ndarray
            Shape (m, 6, n), or (6, n) for one configuration: three rows in m/rad (m/m of sliding joints), then three in rad/rad (rad/m).
        """
    def sag(
        self,
        joints: ArrayLike,
        *,
        factors: Mapping[str, float] | None = None,
        model: Literal["corrected", "calibrated"] = "corrected",
    ) -> _Array:
        """Deflection of the tip under weights: its motion from the pose without compliance of joints and links.

        Shift of its point and its turn, in the axes of the base. Zero if the model has no such terms.

        Parameters
        ----------
        joints
            Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
        factors
            Values of the corrected model's factors by their names, default their references.
        model
            Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.

        Returns
        -------
        numpy.ndarray
            Shape (m, 6), or (6,) for one configuration: the shift in metres, then the turn as a rotation vector in radians.
        """
    @overload
    def compensate(
        self,
        joints: ArrayLike,
        *,
        factors: Mapping[str, float] | None = None,
        nearest: bool = False,
        max_turn_deg: _Number | None = None,
        max_slide_mm: _Number | None = None,
        max_turn_rad: _Number | None = None,
        max_slide_m: _Number | None = None,
        summary: Literal[False] = False,
        model: Literal["corrected", "calibrated"] = "corrected",
        readings: Literal["model", "controller"] | None = None,
    ) -> _Array:
        """Joint readings by which the actual robot's tip reaches the poses of a program for the nominal robot.

        Parameters
        ----------
        joints
            Readings of the program, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
        factors
            Values of the corrected model's factors by their names, default their references.
        nearest
            True to return the nearest configuration if a pose cannot be reached, instead of leaving the row unchanged.
        max_turn_deg, max_slide_mm
            Largest change of a joint that turns, or slides, beyond its zero, default 2 degrees and 2 mm. A row that needs more, at a singularity, is
            unchanged.
        max_turn_rad, max_slide_m
            The same limits in radians and metres.
        summary
            True to return the summary as well.
        model
            Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
        readings
            Meaning of the arrays: "model", readings of the model, or "controller", the controller's counts, by the calibration's mapping; required if
            these differ.

        Returns
        -------
        numpy.ndarray
            Readings to command, of the same shape. A PoecalWarning names the unchanged rows. With summary=True a tuple of these and a `Compensation`:
            `targets` has every corrected row by its index (`line`), `listed` every other one with the reason.
        """
    @overload
    def compensate(
        self,
        joints: ArrayLike,
        *,
        factors: Mapping[str, float] | None = None,
        nearest: bool = False,
        max_turn_deg: _Number | None = None,
        max_slide_mm: _Number | None = None,
        max_turn_rad: _Number | None = None,
        max_slide_m: _Number | None = None,
        summary: Literal[True],
        model: Literal["corrected", "calibrated"] = "corrected",
        readings: Literal["model", "controller"] | None = None,
    ) -> tuple[_Array, Compensation]: ...
    def taught(self, *, model: Literal["corrected", "calibrated"] = "corrected") -> Robot:
        """The nominal robot with base and tool of the actual one: corrected programs move the actual robot to the poses of this one.

        Parameters
        ----------
        model
            Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.

        Returns
        -------
        Robot
            That robot.
        """
    def compensate_program(
        self,
        path: _Path,
        *,
        language: Literal["urscript", "rapid", "krl", "fanuc"] | None = None,
        tool_data: Sequence[str] | None = None,
        work_objects: Sequence[str] | None = None,
        controller_base: str | None = None,
        controller_flange: str | None = None,
        start: str | None = None,
        factors: Mapping[str, float] | None = None,
        nearest: bool = False,
        max_turn_deg: _Number | None = None,
        max_slide_mm: _Number | None = None,
        max_turn_rad: _Number | None = None,
        max_slide_m: _Number | None = None,
        third_axis: Literal["level", "arm"] | None = None,
        check: bool = False,
        model: Literal["corrected", "calibrated"] = "corrected",
    ) -> tuple[bytes, Compensation]:
        """A robot program with its targets corrected in place; everything else is unchanged, byte for byte.

        Parameters
        ----------
        path
            The program for the nominal robot: URScript (.script), RAPID (.mod, .prg, .sys), KRL (.src, .dat) or of FANUC (.ls).
        language
            Its language, by default from the extension of its name.
        tool_data
            Tools in the controller's flange, each "NUMBERS", the tool of programs that set none, or "NAME=NUMBERS"; numbers in the language's
            notation of poses.
        work_objects
            Frames of poses (work object, base, user frame) in the controller's base, as tools.
        controller_base
            The controller's base in the model's, default the same.
        controller_flange
            The controller's flange in the model's tip, default the same.
        start
            Readings of the robot before the first motion, "J1,J2,…" in the language's notation of joints: for programs that begin with a pose and
            state no configuration.
        factors
            Values of the corrected model's factors by their names, default their references.
        nearest
            True to write the nearest configuration if the robot cannot reach a target, instead of leaving it unchanged.
        max_turn_deg, max_slide_mm
            Largest change of a joint that turns, or slides, beyond its zero, default 2 degrees and 2 mm. A target that needs more, at a singularity,
            is unchanged and listed.
        max_turn_rad, max_slide_m
            The same limits in radians and metres.
        third_axis
            Zero of J3 in a program of FANUC: "level" or "arm"; by default from the calibration's mapping and its rows.
        check
            True to compute the remaining error once more, from the written text.
        model
            Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.

        Returns
        -------
        tuple of bytes and Compensation
            The program, and the summary: the number of corrected targets, the unchanged ones with the reason, the largest corrections, and the
            remaining error.
        """
    @overload
    def ik(
        self,
        poses: ArrayLike,
        *,
        near: None = None,
        held: Mapping[str, ArrayLike] | None = None,
        limits: bool = True,
        factors: Mapping[str, float] | None = None,
        model: Literal["corrected", "calibrated"] = "corrected",
    ) -> _Array | list[_Array]:
        """Configurations that have the tip at poses.

        Parameters
        ----------
        poses
            Poses of the tip in the base, shape (m, 4, 4), or one, (4, 4).
        near
            Configurations to which the found ones are nearest, shape (m, n), or one for all, (n,); default all branches, for a robot with six turning
            joints.
        held
            For a robot with seven turning joints: a mapping from the reading that is held to its value (rad), or to one for each pose, shape (m,).
            All branches of the other joints are then found.
        limits
            True to keep the joints' limits.
        factors
            Values of the corrected model's factors by their names, default their references.
        model
            Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.

        Returns
        -------
        numpy.ndarray or list of numpy.ndarray
            With `near` the nearest configuration of each pose, shape (m, n), or (n,) for one pose, NaN if there is none. Without, the branches of
            each pose, a list of arrays of shape (k, n), or one array for one pose.
        """
    @overload
    def ik(
        self,
        poses: ArrayLike,
        *,
        near: ArrayLike,
        held: None = None,
        limits: bool = True,
        factors: Mapping[str, float] | None = None,
        model: Literal["corrected", "calibrated"] = "corrected",
    ) -> _Array: ...
    def validate(
        self,
        measurements: Measurements,
        *,
        refit: _Refit | Sequence[_Refit] | None = None,
        accept: str | None = None,
        accept_model: Literal["corrected", "calibrated"] = "corrected",
        out: _Path | None = None,
        force: bool = False,
        report: bool | _Path = True,
        record: Mapping[str, str] | None = None,
        history: _Path | None = None,
    ) -> Validation:
        """Judges the calibration by measurements that it did not use; every row counts.

        Parameters
        ----------
        measurements
            The measurements.
        refit
            Parts that are refitted to them: "device" (its frame), "tool" (the targets), or a list of both. "auto" refits the device's frame if the
            measurements show that the device moved; otherwise such a move is only reported.
        accept
            Limits that the errors must meet, like "0.2mm" or "0.2mm,max:0.5mm,0.05deg"; see `poecal.calibrate`.
        accept_model
            Model that must meet them: "corrected", if there is one, or "calibrated".
        out
            Folder for the results of the check: validation.json, errors.csv with each row beside its bound, and a report.
        force
            True to overwrite existing results of a check and a report.
        report
            True to write a report among the results, or the path of another file for it.
        record
            Statements of the report about this session, by key; see `poecal.calibrate`.
        history
            File to which the check is appended as a line, like the history.jsonl that the program keeps beside a calibration.

        Returns
        -------
        Validation
            Errors of the nominal and the calibrated robot, their share inside the predicted bounds, and `acceptance`.
        """
    def identify(
        self,
        joints: ArrayLike,
        *,
        kind: _Kind = "pose",
        sigma_position_mm: _Number | None = None,
        sigma_rotation_deg: _Number | None = None,
        device_frame: _Frame = "unknown",
        robot_error_mm: _Number | _Pair | None = None,
    ) -> Identification:
        """Unknowns that measurements of the calibrated robot in stated configurations would determine; see `poecal.identify`.

        Parameters
        ----------
        joints
            Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`.
        kind
            Kind of the measurements of the tip: "pose", "point", or "mixed" (both in turn).
        sigma_position_mm, sigma_rotation_deg
            Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
        device_frame
            The measuring device's frame: "unknown" or "base".
        robot_error_mm
            Remaining error of the tip (RMS) after a calibration with any number of rows, or that and the one with corrections (default those of this
            calibration).

        Returns
        -------
        Identification
            The unknowns that would be determined, and the expected error.
        """
    def _repr_html_(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __copy__(self) -> Calibration: ...
    def __deepcopy__(self, memo: dict[int, Any], /) -> Calibration: ...
    def __reduce__(self) -> tuple[Callable[[bytes], Calibration], tuple[bytes]]: ...
    __hash__: None  # type: ignore[assignment]

@final
class TestPlan:
    """The poses of a test of ISO 9283. `str` is the program's table, `to_dict` what the program prints with `--json`."""
    @property
    def joints(self) -> NDArray[np.float64]:
        """The configurations of all cycles in their order, P5 to P1, shape (5 * cycles, n), radians and metres, in the order of `robot.reading_names`."""
    @property
    def cycles(self) -> int:
        """Number of cycles."""
    def to_json(self) -> str:
        """The poses as JSON.

        Returns
        -------
        str
            The text.
        """
    def to_dict(self) -> dict[str, Any]:
        """The poses as dicts and lists: what the program prints with `--json`.

        Returns
        -------
        dict
            "middle_mm" and "sides_mm" of the cube or plane, "cycles", and the "poses" P1 to P5.
        """
    def write(self, path: _Path, *, force: bool = False) -> None:
        """Writes the table that `poecal.iso9283` reads once it has what was measured.

        Parameters
        ----------
        path
            The file (CSV).
        force
            Whether to write over a file that exists.
        """
    def write_program(self, path: _Path, *, force: bool = False) -> None:
        """Writes all cycles as a program of slow joint motions with a stop at each pose.

        Parameters
        ----------
        path
            The file: its name ends in .script (Universal Robots), .mod (ABB), .src (KUKA) or .ls (FANUC).
        force
            Whether to write over a file that exists.
        """
@final
class Plan:
    """A planned list of configurations. `str` is the program's table, `to_dict` the program's output with `--json`."""
    @property
    def joints(self) -> NDArray[np.float64]:
        """The configurations in the order in which to measure them, shape (m, n), radians and metres, in the order of `robot.reading_names`."""
    @property
    def sets(self) -> list[Literal["fit", "held_out"]]:
        """Purpose of each row: "fit" or "held_out"."""
    @property
    def returns(self) -> list[bool]:
        """Returns, a bool for each row: True if it is the first configuration again."""
    @property
    def candidates(self) -> list[int | None]:
        """Index of each row among the candidates, if these were stated."""
    @property
    def expected_calibrated_mm(self) -> float:
        """Expected error of the calibrated model (RMS over the workspace), millimetres."""
    @property
    def expected_corrected_mm(self) -> float:
        """Expected error of the corrected model (RMS over the workspace), millimetres."""
    @property
    def enough(self) -> int | None:
        """Number of configurations from which ten more gain less than 5 %; None if that is more than 100."""
    def to_json(self) -> str:
        """The plan as JSON.

        Returns
        -------
        str
            The text.
        """
    def to_dataframe(self) -> pandas.DataFrame:
        """The rows as a data frame of pandas, which has to be installed.

        Returns
        -------
        pandas.DataFrame
            The table that `write` writes: "id", "set", "returns", and the readings in degrees and millimetres.
        """
    def to_dict(self) -> dict[str, Any]:
        """The plan as dicts and lists: the program's output with `--json`.

        Returns
        -------
        dict
            The plan, with "curve" and "rows".
        """
    def write(self, path: _Path, *, force: bool = False) -> None:
        """Writes the list as a table that `poecal.Measurements` reads once the measured quantities are filled in.

        Parameters
        ----------
        path
            The file (CSV).
        force
            True to overwrite a file that exists.
        """
    def write_program(self, path: _Path, *, force: bool = False) -> None:
        """Writes the list as a program of slow joint motions with a stop at each row.

        Parameters
        ----------
        path
            The file: its name ends in .script (Universal Robots), .mod (ABB), .src (KUKA) or .ls (FANUC).
        force
            True to overwrite a file that exists.
        """
    def write_report(self, path: _Path, *, force: bool = False) -> None:
        """Writes a page of the plan: the targets of all configurations, some arms, the device, errors by number, the sampled part of each joint's range.

        Parameters
        ----------
        path
            The file (HTML).
        force
            True to overwrite a file that exists.
        """
    def __len__(self) -> int: ...

@final
class Watch:
    """A session that is watched: each row is judged before it is fitted, while the target is still in place.

    Parameters
    ----------
    robot
        The nominal robot, or a calibrated one.
    candidates
        Configurations to choose the next from, shape (m, n) (default random ones within the limits).
    workspace
        Configurations in which the robot will work, shape (m, n) (default anywhere within the limits).
    workspace_box_mm
        Two corners of a box of the base frame in which the tip will work, shape (2, 3), instead of `workspace`.
    sigma_position_mm, sigma_rotation_deg
        Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
    robot_error_mm
        Remaining error of the tip (RMS) after a calibration with any number of rows, as of `plan`.
    device_frame
        The measuring device's frame: "unknown" or "base".
    tolerance_deg_mm
        Prior of the fit: deviation of each axis from nominal, as standard deviations, or None.
    corrections
        Expected joint effects beyond geometry, as of `plan`.
    gravity
        Direction of gravity in the robot's base frame, default (0, 0, -1).
    seed
        Seed of everything random.
    """
    def __new__(
        cls,
        robot: Robot,
        *,
        candidates: ArrayLike | None = None,
        workspace: ArrayLike | None = None,
        workspace_box_mm: ArrayLike | None = None,
        sigma_position_mm: _Number | None = None,
        sigma_rotation_deg: _Number | None = None,
        robot_error_mm: _Number | _Pair | None = None,
        device_frame: _Frame = "unknown",
        tolerance_deg_mm: _Pair | None = ...,
        corrections: str | Mapping[str, _Number] = "auto",
        gravity: ArrayLike = (0, 0, -1),
        seed: int = 1,
    ) -> Watch: ...
    def add(
        self,
        joints: ArrayLike,
        *,
        position: ArrayLike | None = None,
        pose: ArrayLike | None = None,
        target: str | None = None,
        id: str | None = None,
    ) -> WatchedRow:
        """Judges one row, and fits it if it is as expected.

        Parameters
        ----------
        joints
            Readings, shape (n,), radians and metres, in the order of `robot.reading_names`.
        position
            Position of the target in the device's frame, shape (3,), metres.
        pose
            Pose device_from_target instead of `position`, shape (4, 4).
        target
            Name of the target, default the tip itself.
        id
            Name of the row.

        Returns
        -------
        WatchedRow
            Comparison of the row with the expectation (`ok`, None while there are too few rows), or else its `mistake`; the detectable error
            (`noticed_mm`); the expected errors now and after ten more rows; the configuration that gains most (`next`).
        """
    def add_all(self, measurements: Measurements) -> list[WatchedRow]:
        """Judges the rows of measurements in sequence.

        Parameters
        ----------
        measurements
            The rows.

        Returns
        -------
        list of WatchedRow
            Results as of `add`, one for each row.
        """
    def __len__(self) -> int: ...

@final
class Simulation:
    """A simulated session: nominal and actual robot, and measurements of the actual one."""
    @property
    def nominal(self) -> Robot:
        """The nominal robot."""
    @property
    def actual(self) -> Robot:
        """The actual robot."""
    @property
    def measurements(self) -> Measurements:
        """The measurements."""
    @property
    def held_out(self) -> Measurements | None:
        """Further rows, free of noise, for validation of a calibration; None if none were requested."""
    @property
    def device_from_base(self) -> _Array:
        """Pose of the base in the measuring device, shape (4, 4)."""
    def write(self, folder: _Path, *, force: bool = False) -> list[str]:
        """Writes both robots, the measurements and the truth to a folder, as the program does.

        Parameters
        ----------
        folder
            The folder.
        force
            True to overwrite files that exist.

        Returns
        -------
        list of str
            Names of the files.
        """

def calibrate(
    robot: Robot | _Path,
    measurements: Measurements | _Path | Sequence[_Path],
    *,
    device_frame: _Frame = "unknown",
    sigma_position_mm: _Number | None = None,
    sigma_rotation_deg: _Number | None = None,
    tolerance_deg_mm: _Pair | None = ...,
    corrections: str | Mapping[str, _Number] = "auto",
    harmonics: int = 2,
    gravity: Sequence[float] | Literal["find"] = ...,
    fix: Sequence[str] | None = None,
    free: Sequence[str] | None = None,
    move_tip: bool = False,
    held_out: float | None = None,
    seed: int | None = None,
    robust: Literal["auto", "off", "huber", "cauchy", "tukey"] = "auto",
    repair: Literal["auto", "off"] = "auto",
    repair_limit: str | None = None,
    formulation: Literal["adjoint", "screw", "screw-offsets", "adjoint-offsets"] = "adjoint",
    residual: Literal["tool", "spatial"] = "tool",
    method: Literal["levenberg-marquardt", "gauss-newton"] | None = None,
    validate: Measurements | _Path | Sequence[_Path] | None = None,
    accept: str | None = None,
    accept_model: Literal["corrected", "calibrated"] = "corrected",
    record: Mapping[str, str] | None = None,
    progress: Callable[[str], object] | bool | None = None,
) -> Calibration:
    """Calibrates a robot from measurements.

    Parameters
    ----------
    robot
        The nominal robot, or the path of its model.
    measurements
        Its measurements, or the path of their file, or several paths.
    device_frame
        The measuring device's frame: "unknown" or "base".
    sigma_position_mm, sigma_rotation_deg
        Standard deviation of each measured component, default estimated from the data.
    tolerance_deg_mm
        Prior: deviation of each axis from nominal, standard deviations of angle and position (default 0.5 deg and 5 mm), or None. It decides for
        unknowns that the measurements do not determine. "auto" takes the best of (0.05, 0.5), (0.2, 2), (0.5, 5), (1, 10) and (3, 10) by
        cross-validation. The path of a MOC.cfg of a controller of ABB uses the maker's calibration.
    corrections
        Joint effects beyond geometry. "auto" fits the terms with the best prediction of rows that were not fitted, "all" searches more of them, "off"
        fits none. Or groups of terms, some of "sag,tilt,ratio,harmonics,wobble,backlash,factors,payload,shift,runout", or a dict of their sizes in
        radians or metres, or as texts with a unit.
    harmonics
        Highest order of the harmonics of a turn among these terms, 1 to 8 (default 2).
    gravity
        Direction of gravity in the robot's base frame, default (0, 0, -1), or "find": the direction for which the terms leave the least noise.
    fix
        Blocks to hold as in the model: "joints", "targets", "frames", or names like "joint2.axis", in which * matches any letters.
    free
        Blocks to fit, also those that are held by default, like "joint2.offset", and after `fix`.
    move_tip
        True to put the tip at the measured point, for a model that ends in its reflector. Otherwise the links beyond the last joint stay as in the
        model, and the point is the target "measured".
    held_out
        Share of the configurations held out, if nothing else determines the rows; 0 fits every row (default 0.3; 0 if fewer than 12 would be held
        out, except for pictures, rows in motion and `accept`).
    seed
        Seed of that choice (default 1).
    robust
        Treatment of outliers: "auto", "off", "huber", "cauchy" or "tukey".
    repair
        "auto" repairs a session in which a device, a target, a nest or a joint's zero evidently moved, or configurations are wrong as a whole, if
        that improves the prediction of other rows; "off" only reports it. `Calibration.to_dict()` has `repairs` and `suspicions`.
    repair_limit
        Largest repair of a device (default 50 mm), a tool (20 mm) or a zero (5 deg), like "device=100mm" or "tool=30mm,zero=10deg"; turns count as
        arcs at a third of the robot's reach. A larger motion is named, not repaired.
    formulation
        Parameterisation of joint errors: "adjoint", "screw", "screw-offsets" or "adjoint-offsets".
    residual
        Residual of measured frames: "tool" or "spatial".
    method
        "levenberg-marquardt" or "gauss-newton" (default for formulations with free screws).
    validate
        Measurements for validation: all other rows are fitted.
    accept
        Limits that the errors of rows that were not fitted must meet, like "0.2mm" or "0.2mm,max:0.5mm,0.05deg": rms (the default), p95 or max of all
        errors in a unit. `Calibration.acceptance` reports whether each is shown to be kept.
    accept_model
        Model that must meet them: "corrected", if there is one, or "calibrated".
    record
        Statements of the report about the session: a dict of texts with keys among "certificate", "laboratory", "customer", "robot", "serial",
        "instrument", "operator", "date", "place", "temperature" and "note".
    progress
        Called with the next stage, in words; True for a bar on standard error.

    Returns
    -------
    Calibration
        The calibrated robot, its errors, and the verdict on its trustworthiness.

    Raises
    ------
    ProblemError
        There are too few measurements.
    OptionError
        An argument is out of range.
    SolverError
        No finite result is reached.
    """
def check(
    robot: Robot | _Path, measurements: Measurements | _Path | Sequence[_Path] | None = None, *, device_frame: _Frame = "unknown"
) -> Check:
    """Interpretation of a model and measurements, and the mistakes that they show.

    Parameters
    ----------
    robot
        The nominal robot, or the path of its model.
    measurements
        Its measurements, or the path of their file, or several paths; None if there are none yet.
    device_frame
        The measuring device's frame; with "base", mistakes in it are searched too.

    Returns
    -------
    Check
        The interpretation, with mistakes under "diagnosis".
    """
def compare(first: Calibration, second: Calibration, *, limit_mm: _Number | None = None) -> Comparison:
    """Changes between two calibrations of one robot, and their comparison with noise.

    Parameters
    ----------
    first, second
        The calibrations.
    limit_mm
        Largest permitted motion of the tip (RMS), default the expected errors of both together.

    Returns
    -------
    Comparison
        Motion of the tip (`tip`), its comparison with the limit (`moved`), the test of all changes against noise (`changed`), and each joint's change
        with its test.
    """
def export(
    robot: Robot,
    *,
    format: _Form | None = None,
    offset: dict[str, float] | None = None,
    out: _Path | None = None,
    force: bool = False,
) -> str:
    """A robot in another form, as a text, and as a file too if one is named.

    Parameters
    ----------
    robot
        The robot.
    format
        "urdf" (a new one, of links, joints and a tip) or "toml" (a table of screws), by default from the extension of `out`.
    offset
        Offsets of joint values by the joints' names, radians or metres, or texts with a unit: the text has the screws and home pose of the robot with
        these offsets. Mimic joints that follow a joint stay.
    out
        The file.
    force
        True to overwrite a file that exists.

    Returns
    -------
    str
        The text.
    """
def guess_columns(path: _Path, robot: Robot | _Path, *, columns: Mapping[str, str] | None = None) -> ColumnGuess:
    """Guesses the columns of joints and measured quantities in a foreign file, as `poecal init --columns-from` does.

    Check the mapping, save it (`Path("columns.toml").write_text(guess.mapping)`), and read the file by `Measurements.from_csv(path, robot,
    columns="columns.toml")`.

    Parameters
    ----------
    path
        The file: CSV or a workbook.
    robot
        The robot, or the path of its model.
    columns
        Columns or words in place of the guess, by the keys of `fields`: `{"position.x": "Tx"}`; an empty text for none.

    Returns
    -------
    ColumnGuess
        The columns of the file, the fields of a mapping with their choices, unused columns, and the mapping as a text (TOML).
    """
def iso9283(
    measurements: _Path,
    robot: Robot | _Path | None = None,
    *,
    device_frame: Literal["unknown", "base", "calibration"] = "unknown",
    sigma_position_mm: _Number | None = None,
    sigma_rotation_deg: _Number | None = None,
    units: str | None = None,
    accept: str | None = None,
    record: Mapping[str, str] | None = None,
    earlier: _Path | None = None,
    report: _Path | None = None,
    certificate: bool = False,
    force: bool = False,
) -> Iso9283:
    """Accuracy and repeatability of a robot after ISO 9283:1998, each figure with its 95 % interval.

    Parameters
    ----------
    measurements
        Path of the rows: commanded and measured poses, and the columns pose, cycle, approach, series, arm, speed, payload as far as there are any.
    robot
        The robot whose joint readings the rows have instead of commanded_x, commanded_y, commanded_z, or the path of its model; of a calibration.json also
        the accuracy of corrected commands is predicted.
    device_frame
        The measuring device's frame: "unknown", "base" or "calibration".
    sigma_position_mm, sigma_rotation_deg
        Standard deviation of the instrument in each component, for rows that state none.
    units
        Units of columns that state none, like "mm,deg".
    accept
        Limits that figures must keep, like "AP:0.5mm,RP:0.05mm".
    record
        What is stated of the test, by the keys of `poecal calibrate --record`.
    earlier
        Path of the rows of the same test before the calibration, whose figures stand beside; with a calibration.json also what they predict.
    report
        File for a page (HTML) with all figures, the cube and the scatter of each pose; its print begins with a certificate.
    certificate
        Whether that page is the certificate alone, one page of A4.
    force
        Whether to write over a file that exists.

    Returns
    -------
    Iso9283
        The "figures", each with "found", "from" and "to" in "unit", and the "decision" on the limits.
    """
def hand_eye(
    base_from_flange: ArrayLike,
    camera_from_target: ArrayLike,
    *,
    camera: Literal["in-hand", "beside"],
    flange: Literal["base-from-flange", "flange-from-base"] | None = None,
    target: Literal["camera-from-target", "target-from-camera"] | None = None,
    names: Sequence[str] | None = None,
    frame_names: Sequence[str] | None = None,
) -> HandEye:
    """Pose of a camera on the flange or beside the robot, from poses of the flange and of a board that it saw.

    The result has bounds of 95 %. Mistakes in the poses are named, wrong poses left out.

    Parameters
    ----------
    base_from_flange
        Poses of the arm's flange, shape (m, 4, 4), metres; for joint readings `robot.forward_kinematics(joints)`.
    camera_from_target
        Poses of the board or marker as the camera saw it there, shape (m, 4, 4), metres.
    camera
        Position of the camera: "in-hand" or "beside".
    flange, target
        Sense of the poses: "base-from-flange" or "flange-from-base", "camera-from-target" or "target-from-camera". By default it is recognised, and
        reported under "findings".
    names
        Names of the rows in messages.
    frame_names
        Names of base, flange, camera and target in the result.

    Returns
    -------
    HandEye
        The frame of the camera, "camera_frame", and of the board, "target_frame", each with "matrix", "bound95_mm" and "bound95_deg"; the "verdict",
        the held-out errors, and "findings": all entries of `hand_eye.json`.
    """
def identify(
    robot: Robot,
    joints: ArrayLike,
    *,
    kind: _Kind = "pose",
    sigma_position_mm: _Number | None = None,
    sigma_rotation_deg: _Number | None = None,
    device_frame: _Frame = "unknown",
    robot_error_mm: _Number | _Pair | None = None,
) -> Identification:
    """Unknowns that measurements in stated configurations would determine, before anything is measured.

    Parameters
    ----------
    robot
        The robot.
    joints
        Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`.
    kind
        Kind of the measurements of the tip: "pose", "point", or "mixed" (both in turn).
    sigma_position_mm, sigma_rotation_deg
        Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
    device_frame
        The measuring device's frame: "unknown" or "base".
    robot_error_mm
        Remaining error of the tip (RMS) after a calibration with any number of rows, or that and the one with corrections. By default those of a
        calibration of this robot, else 0.3 mm for each metre of reach, which is a guess.

    Returns
    -------
    Identification
        The unknowns that would be determined, and the expected error.
    """
def init(
    model: _Path,
    out: _Path,
    *,
    kind: Literal[
        "point",
        "pose",
        "distance",
        "distance-change",
        "sphere",
        "socket",
        "plane",
        "height",
        "flush",
        "direction",
        "ball-bar",
        "relative",
        "component",
    ] = "point",
    count: int = 60,
    seed: int = 1,
    base_link: str | None = None,
    tip_link: str | None = None,
    instruments: Mapping[str, str] | None = None,
    targets: Mapping[str, str] | None = None,
) -> list[str]:
    """Writes a project folder to start from.

    It has the model, a measurement file to fill in, configurations to measure, settings for `poecal calibrate`, and instructions.

    Parameters
    ----------
    model
        Path of a robot model of any form.
    out
        The folder; files in it are never overwritten.
    kind
        Kind of the measurements: "point", "pose", "distance", "distance-change", "sphere", "socket", "plane", "height", "flush", "direction",
        "ball-bar", "relative" or "component".
    count
        Number of configurations to suggest, from 1 to 100,000.
    seed
        Seed of their choice.
    base_link, tip_link
        The chain of a URDF that has several.
    instruments, targets
        Names of instruments on the robot and of targets, with their links in a URDF: the robot is the tree of the joints to these.

    Returns
    -------
    list of str
        Names of the files.
    """
def offsets(
    nominal: Robot, actual: Robot | Calibration, *, free: Sequence[_End] | None = None, fix: Sequence[_End] | None = None
) -> Offsets:
    """The joint offsets of the best fit of a model's tip to that of a robot, and the remaining errors.

    Parameters
    ----------
    nominal
        The model.
    actual
        The robot, or a calibration of it.
    free, fix
        Frames "base" and "tip" that are fitted with the offsets, and those that are equal in both; by default those that a calibration fitted are
        free.

    Returns
    -------
    Offsets
        The offsets, and the errors with and without them.
    """
def read_joints(path: _Path, robot: Robot, *, columns: _Path | None = None, units: str | None = None) -> _Array:
    """Reads the joint readings of a file; other columns are ignored.

    Parameters
    ----------
    path
        The file.
    robot
        The robot whose joints the columns name.
    columns
        A mapping file for a file with other column names.
    units
        Units of columns that state none, "mm,deg"; a mapping file takes precedence.

    Returns
    -------
    numpy.ndarray
        Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`.
    """
def recalibrate(
    calibration: Calibration,
    measurements: Measurements,
    earlier: Measurements | None = None,
    *,
    part: str,
    device: Literal["refit", "known"] = "refit",
    tool: Literal["same", "refit"] = "same",
    repeatability_mm: _Number | None = None,
) -> Calibration:
    """Recalibrates the zero or the axis of one joint by the few measurements of a visit, with everything else held.

    Parameters
    ----------
    calibration
        The earlier calibration.
    measurements
        Measurements of the visit, as of `track`.
    earlier
        The rows of the calibration, or those of an earlier visit; None: the visit is judged by the model.
    part
        Recalibrated part: the zero of a joint ("joint2" or "joint2.offset"), or its axis ("joint2.axis").
    device
        "refit" if the device was set up anew, so that its frame is fitted; "known" if it stands where it stood.
    tool
        "same" if the tool stayed on the flange; "refit" if it was mounted anew, so that its targets are fitted.
    repeatability_mm
        Standard deviation of one visit and coordinate; None: estimated from repeats within a visit and from the changes that no explanation removes.

    Returns
    -------
    Calibration
        The calibration with this joint corrected. `write(folder)` writes it.
    """
def reproduce(
    experiment: Literal["lou2009", "breakdown"],
    *,
    out: _Path | None = None,
    force: bool = False,
    trials: int = 1000,
    starts: int = 100,
    seed: int = 1,
) -> Reproduction:
    """Repeats the experiment of a paper and checks its claims, or shows the effect of gross errors.

    Parameters
    ----------
    experiment
        "lou2009" (the paper) or "breakdown" (gross errors).
    out
        Folder for the report.
    force
        True to overwrite files that exist.
    trials
        Number of sessions that compare the formulations, or the losses.
    starts
        Number of random starts for each size of error (lou2009).
    seed
        Seed of everything random.

    Returns
    -------
    Reproduction
        The runs, and the claims with their results.
    """
def run_program(arguments: Sequence[str]) -> int:
    """Runs the program `poecal`.

    Parameters
    ----------
    arguments
        The program's name, and its arguments.

    Returns
    -------
    int
        The exit code.
    """
def schema() -> str:
    """The JSON Schema of calibration.json.

    Returns
    -------
    str
        The schema, as a text.
    """
def set_limit(name: str, most: int | str) -> None:
    """Sets a limit of files, if the default is less than they need.

    Parameters
    ----------
    name
        The limit: `rows`, `columns`, `text`, `cells`, `bag` and the others of SECURITY.md.
    most
        The number, of bytes also as a text such as `"2GiB"`. It holds for all calls from then on.
    """
def set_threads(count: int) -> None:
    """Sets the number of threads that all work shares; results do not depend on it.

    Parameters
    ----------
    count
        From 1 to 256. It can be set once, before anything is computed.
    """
def simulate(
    robot: Robot,
    *,
    kind: _Kind = "pose",
    count: int = 50,
    seed: int = 1,
    error_position_mm: _Number = 2.0,
    error_rotation_deg: _Number = 1.0,
    noise_position_mm: _Number = 0.05,
    noise_rotation_deg: _Number = 0.01,
    device_frame: _Frame = "unknown",
    held_out_count: int = 0,
    terms: str | Mapping[str, _Number] = "off",
    gravity: Sequence[float] = ...,
) -> Simulation:
    """Simulates a robot with errors and its measurements, for tests and for learning.

    Parameters
    ----------
    robot
        The nominal robot, from which the actual one deviates.
    kind
        Kind of the measurements: "pose", "point", or "mixed" (both in turn).
    count
        Number of measurements.
    seed
        Seed of everything random.
    error_position_mm, error_rotation_deg
        Distance and angle of the error of every axis, and of the tip.
    noise_position_mm, noise_rotation_deg
        Standard deviation of each measured component.
    device_frame
        The measuring device's frame: "unknown" or "base".
    held_out_count
        Number of further measurements, free of noise, for validation of a calibration.
    terms
        Joint effects beyond geometry: "off", or groups of terms with the standard deviations of their coefficients in radians or metres, as a dict
        (also of texts with a unit) or "sag=1e-3,ratio=1e-4".
    gravity
        Direction of gravity in the robot's base frame, default (0, 0, -1).

    Returns
    -------
    Simulation
        Both robots, and the measurements of the actual one.
    """
def tcp(
    base_from_flange: ArrayLike,
    *,
    points: Sequence[str] | None = None,
    tips: Sequence[str] | None = None,
    names: Sequence[str] | None = None,
) -> ToolTip:
    """The tip of a tool from poses of the flange in which it touched a fixed point.

    The result has bounds of 95 %. Wrong touches are named and left out.

    Parameters
    ----------
    base_from_flange
        Poses of the arm's flange at the touches, shape (m, 4, 4), metres.
    points
        The touched point of each touch, if there are several.
    tips
        The touching tip of each touch, of two tips along the tool, for the tool's direction.
    names
        Names of the rows in messages.

    Returns
    -------
    ToolTip
        The "tips", with "position_m" and "bound95_mm", the "axis" of two, and the "verdict": all entries of `tcp.json`.
    """
@overload
def plan(
    robot: Robot | Calibration | _Path,
    *,
    purpose: Literal["calibration"] = "calibration",
    kind: _Kind = "point",
    count: int | None = None,
    held_out_count: int | None = None,
    candidates: ArrayLike | None = None,
    workspace: ArrayLike | None = None,
    workspace_box_mm: ArrayLike | None = None,
    keep_rows: Plan | ArrayLike | None = None,
    replace_rows: Sequence[int] | None = None,
    criterion: Literal["expected", "D", "A", "E", "G"] = "expected",
    targets: int = 1,
    target_offset_mm: ArrayLike | None = None,
    sigma_position_mm: _Number | None = None,
    sigma_rotation_deg: _Number | None = None,
    robot_error_mm: _Number | _Pair | None = None,
    device_frame: _Frame = "unknown",
    tolerance_deg_mm: _Pair | None = ...,
    corrections: str | Mapping[str, _Number] = "auto",
    gravity: ArrayLike = (0, 0, -1),
    margin_deg_mm: _Pair | None = None,
    keep_out_mm: Sequence[ArrayLike] | None = None,
    floor_height_mm: _Number | None = None,
    separation_deg: _Number | None = None,
    device_mm: ArrayLike | None = None,
    device_half_angle_deg: _Number | None = None,
    device_aim_mm: ArrayLike | None = None,
    distance_mm: _Pair | None = None,
    target_half_angle_deg: _Number | None = None,
    target_normal: ArrayLike | None = None,
    self_collision: Literal["avoid", "ignore"] = "avoid",
    stop_s: float = 30.0,
    seed: int = 1,
    earlier: None = None,
    device: None = None,
    tool: None = None,
    repeatability_mm: None = None,
    target: None = None,
) -> Plan:
    """Plans a session: configurations that determine the most, rows for validation, the worthwhile number, and the expected error.

    With `purpose="drift"` it plans visits to a calibrated robot: the measured configurations whose repeats detect the smallest shift of the worst
    joint. `candidates`, `count`, `earlier`, `device`, `tool` and `repeatability_mm` state the knowledge of the visits, `target` the target that will
    be measured.

    Parameters
    ----------
    robot
        The robot, or the path of its model; a calibration, or a robot that was read from a calibration.json, plans the next session of it.
    purpose
        "calibration", "drift" for visits to a calibration, or "iso9283" for a test of ISO 9283: P1 to P5 of the largest cube, with `count` cycles (default
        30), `floor_height_mm`, and `workspace_box_mm` for a stated cube, or a plane, of which one side is zero.
    kind
        Kind of the measurements of the tip: "point", "pose", "mixed" or "distance".
    count
        Number of different configurations to fit, from 1 to 1000 (default 30); with "drift" to measure at each visit (default 8).
    held_out_count
        Number of further rows for validation, at random over the workspace (default a third of `count`).
    candidates
        Configurations to choose from alone, shape (m, n).
    workspace
        Configurations in which the robot will work, shape (m, n), where predictions shall be good (default anywhere within the limits).
    workspace_box_mm
        Two corners of a box of the base frame in which the tip will work, shape (2, 3), instead of `workspace`.
    keep_rows
        Existing rows, which new ones complete: a `Plan`, or configurations to fit of shape (m, n). `count` counts both.
    replace_rows
        Rows of `keep_rows`, from 0, that could not be measured: they are replaced, and all other rows stay.
    criterion
        "expected" (expected error of the calibrated and the corrected model), or a measure of the design: "D", "A", "E", "G".
    targets
        Number of targets of a nest at the tip, from 1 to 8, all measured in each configuration.
    target_offset_mm
        Position of the target in the tip's frame; for several the first, the others turned about z.
    sigma_position_mm, sigma_rotation_deg
        Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
    robot_error_mm
        Remaining error of the tip (RMS) after a calibration with any number of rows, or that and the one with corrections. By default those of a
        calibration of this robot, else 0.3 mm for each metre of reach is assumed.
    device_frame
        The measuring device's frame: "unknown" or "base".
    tolerance_deg_mm
        Prior of the fit: deviation of each axis from nominal, as standard deviations, or None.
    corrections
        Expected joint effects beyond geometry: "auto" and "all" terms of the common sizes, "off" nothing, or groups with their sizes.
    gravity
        Direction of gravity in the robot's base frame, default (0, 0, -1).
    margin_deg_mm
        Distance of every joint from its limits; None for 2 degrees and 5 mm, and for none of a list of candidates.
    keep_out_mm
        Boxes into which no part of the robot may reach, each two corners in the base frame.
    floor_height_mm
        Height above which all links that move stay.
    separation_deg
        Least change of some joint between any two configurations.
    device_mm
        Position of the measuring device in the base frame; targets that links hide from it are left out.
    device_half_angle_deg, device_aim_mm
        Half the angle of the device's cone, and the point at which it is aimed (default the base).
    distance_mm
        Least and largest distance of the target from the device.
    target_half_angle_deg, target_normal
        Largest angle between the normal of the target, in its own frame (default (0, 0, 1)), and the line to the device.
    self_collision
        "avoid" overlaps of links by their shapes in the URDF, or "ignore" shapes.
    stop_s
        Duration of the robot's stop at each row, for the total duration.
    seed
        Seed of everything random.
    earlier
        For "drift": rows of the calibration or of an earlier visit whose configurations may be repeated (default those of the calibration).
    device
        For "drift": "known" if the device will stand where it stood, "refit" if not (default "known" of a calibration with device_frame="base").
    tool
        For "drift": "same" if the tool will be on the flange as it was, "refit" if not (default "same").
    target
        For "drift": the target that will be measured, of several (default all targets of the rows).
    repeatability_mm
        For "drift": standard deviation of one visit and coordinate, as repeats show it (default the noise of the calibration).

    Returns
    -------
    Plan, VisitPlan or TestPlan
        The rows in the order of their measurement, with the expected errors; with "drift" the detectable shift of each joint. Only configurations are
        checked, never the path between them.
    """
@overload
def plan(
    robot: Calibration,
    *,
    purpose: Literal["drift"],
    count: int | None = None,
    candidates: ArrayLike | None = None,
    earlier: Measurements | None = None,
    device: Literal["known", "refit"] | None = None,
    tool: Literal["same", "refit"] | None = None,
    repeatability_mm: _Number | None = None,
    target: str | None = None,
) -> VisitPlan: ...
@overload
def plan(
    robot: Robot | Calibration | _Path,
    *,
    purpose: Literal["iso9283"],
    count: int | None = None,
    workspace_box_mm: ArrayLike | None = None,
    floor_height_mm: _Number | None = None,
) -> TestPlan: ...
@overload
def plan(
    robot: Robot | Calibration | _Path,
    *,
    purpose: Literal["calibration", "drift", "iso9283"],
    kind: _Kind = "point",
    count: int | None = None,
    held_out_count: int | None = None,
    candidates: ArrayLike | None = None,
    workspace: ArrayLike | None = None,
    workspace_box_mm: ArrayLike | None = None,
    keep_rows: Plan | ArrayLike | None = None,
    replace_rows: Sequence[int] | None = None,
    criterion: Literal["expected", "D", "A", "E", "G"] = "expected",
    targets: int = 1,
    target_offset_mm: ArrayLike | None = None,
    sigma_position_mm: _Number | None = None,
    sigma_rotation_deg: _Number | None = None,
    robot_error_mm: _Number | _Pair | None = None,
    device_frame: _Frame = "unknown",
    tolerance_deg_mm: _Pair | None = ...,
    corrections: str | Mapping[str, _Number] = "auto",
    gravity: ArrayLike = (0, 0, -1),
    margin_deg_mm: _Pair | None = None,
    keep_out_mm: Sequence[ArrayLike] | None = None,
    floor_height_mm: _Number | None = None,
    separation_deg: _Number | None = None,
    device_mm: ArrayLike | None = None,
    device_half_angle_deg: _Number | None = None,
    device_aim_mm: ArrayLike | None = None,
    distance_mm: _Pair | None = None,
    target_half_angle_deg: _Number | None = None,
    target_normal: ArrayLike | None = None,
    self_collision: Literal["avoid", "ignore"] = "avoid",
    stop_s: float = 30.0,
    seed: int = 1,
    earlier: Measurements | None = None,
    device: Literal["known", "refit"] | None = None,
    tool: Literal["same", "refit"] | None = None,
    repeatability_mm: _Number | None = None,
    target: str | None = None,
) -> Plan | VisitPlan | TestPlan: ...
def track(
    calibration: Calibration,
    measurements: Measurements,
    earlier: Measurements | None = None,
    *,
    device: Literal["refit", "known"] = "refit",
    tool: Literal["same", "refit"] = "same",
    repeatability_mm: _Number | None = None,
    report: _Path | None = None,
    record: Mapping[str, str] | None = None,
    force: bool = False,
) -> Visit:
    """Detection of a robot's change since its calibration by a few measurements, with the changed joint.

    Parameters
    ----------
    calibration
        The calibration.
    measurements
        Measurements of the visit: best some configurations of the calibration again.
    earlier
        The rows of the calibration, or those of an earlier visit: rows that repeat their configurations are compared with them. None: all are judged
        by the model.
    device
        "refit" if the device was set up anew, so that its frame is fitted; "known" if it stands where it stood.
    tool
        "same" if the tool stayed on the flange; "refit" if it was mounted anew, so that its targets are fitted.
    repeatability_mm
        Standard deviation of one visit and coordinate; None: estimated from repeats within a visit and from the changes that no explanation removes.
    report
        File for the page of the visit: then and now, on one page of A4 to sign.
    record
        Statements of the page about this visit, as {"operator": "Mia"}.
    force
        True to overwrite a file that exists.

    Returns
    -------
    Visit
        The state, the explanation with its size, others that explain the changes nearly as well, joints that are not seen, and the present error.
    """
def version() -> str:
    """The version of poecal.

    Returns
    -------
    str
        The version from which this module was built.
    """
def _robot(state: bytes) -> Robot: ...
def _measurements(state: bytes) -> Measurements: ...
def _calibration(state: bytes) -> Calibration: ...
def _shown(text: str, warnings: Sequence[str]) -> str: ...
def _renamed(word: str, words: Sequence[str]) -> str | None: ...
def _nearest(word: str, words: Sequence[str]) -> str | None: ...
def _write_text(path: _Path, text: str, force: bool) -> None: ...
