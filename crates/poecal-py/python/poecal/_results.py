"""Results about a calibrated robot and its models, with the important numbers as attributes."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any

from ._findings import Findings, imported, table

if TYPE_CHECKING:
    import numpy as np
    # Of a private name, since pandas has no types, so that stubtest would look for it where this runs.
    import pandas as _pandas  # type: ignore[import-untyped, import-not-found, unused-ignore]
    from numpy.typing import NDArray

class Check(Findings):
    """Interpretation of a model and measurements: the result of `check`. Its data frame has a row for each column of a file that was read."""

    __slots__ = ()

    @property
    def count(self) -> int:
        """Number of rows that were read."""
        return sum((self["sets"] or {}).values())

    @property
    def joints(self) -> list[str]:
        """Names of the joints."""
        return [joint["name"] for joint in self["model"]["joints"]]

    @property
    def mistakes(self) -> list[str]:
        """Mistakes that the measurements show, a sentence each with the remedy."""
        return [found["statement"] for found in self["diagnosis"]]

    def _rows(self) -> list[dict[str, Any]]:
        return [{"file": file["path"], **column} for file in self["files"] for column in file["columns"]]


class Offsets(Findings):
    """The joint offsets that explain most of a deviation: the result of `offsets`. Its data frame has a row for each joint."""

    __slots__ = ()

    @property
    def offsets_deg(self) -> dict[str, float]:
        """The offset of each joint that turns, degrees."""
        return {joint["joint"]: joint["offset_deg"] for joint in self["joints"] if joint["offset_deg"] is not None}

    @property
    def offsets_mm(self) -> dict[str, float]:
        """The offset of each joint that slides, millimetres."""
        return {joint["joint"]: joint["offset_mm"] for joint in self["joints"] if joint["offset_mm"] is not None}

    @property
    def undetermined(self) -> list[str]:
        """Names of the joints whose offsets the comparison does not determine."""
        return self._texts("undetermined")

    @property
    def without_rms_mm(self) -> float:
        """Error of the tip without the offsets (RMS), millimetres."""
        return self._at(float, "predictions", "without_offsets", "position_rms_mm")

    @property
    def with_rms_mm(self) -> float:
        """Error of the tip with the offsets (RMS), millimetres."""
        return self._at(float, "predictions", "with_offsets", "position_rms_mm")

    @property
    def with_max_mm(self) -> float:
        """Largest error of the tip with the offsets, millimetres."""
        return self._at(float, "predictions", "with_offsets", "position_max_mm")

    def _rows(self) -> list[dict[str, Any]]:
        return list(self["joints"])


class Comparison(Findings):
    """Changes between two calibrations: the result of `compare`. Its data frame has a row for each joint."""

    __slots__ = ()

    @property
    def moved(self) -> bool | None:
        """True if the tip moved by more than the limit; None without a limit."""
        return self._maybe(bool, "moved")

    @property
    def tip_rms_mm(self) -> float:
        """Motion of the tip (RMS), millimetres."""
        return self._at(float, "tip", "rms_mm")

    @property
    def tip_max_mm(self) -> float:
        """Largest motion of the tip, millimetres."""
        return self._at(float, "tip", "max_mm")

    @property
    def tip_rms_deg(self) -> float:
        """Turn of the tip (RMS), degrees."""
        return self._at(float, "tip", "rms_deg")

    @property
    def limit_mm(self) -> float | None:
        """Largest permitted motion of the tip (RMS), millimetres."""
        return self._maybe(float, "tip", "limit_mm")

    @property
    def changed(self) -> bool | None:
        """True if more changed than noise explains; None without the uncertainty of both calibrations."""
        return self._maybe(bool, "changed")

    @property
    def changed_joints(self) -> list[str]:
        """Names of the joints that changed by more than noise explains."""
        return self._texts("changed_joints")

    def _rows(self) -> list[dict[str, Any]]:
        return list(self["joints"])


class ColumnGuess(Findings):
    """Guessed columns of joints and measured quantities in a foreign file: the result of `guess_columns`.

    `str` is the mapping file. Its data frame has a row for each field of the mapping.
    """

    __slots__ = ()

    @property
    def mapping(self) -> str:
        """The mapping file (TOML)."""
        return self._at(str, "mapping")

    @property
    def columns(self) -> list[str]:
        """The columns of the file, in their order."""
        return [column["name"] for column in self["columns"]]

    @property
    def chosen(self) -> dict[str, str]:
        """The column or word that was chosen for each field of the mapping; fields without one are left out."""
        return {field["key"]: field["chosen"] for field in self["fields"] if field["chosen"]}

    @property
    def ignored(self) -> list[str]:
        """Columns that are not read."""
        return self._texts("ignored")

    @property
    def missing(self) -> list[str]:
        """Fields without a column that are required for reading."""
        return self._texts("missing")

    def _rows(self) -> list[dict[str, Any]]:
        return list(self["fields"])


class Validation(Findings):
    """A calibration judged by measurements that it did not use: the result of `Calibration.validate`.

    Figures are those of the delivered model. Its data frame has a row for each model and quantity.
    """

    __slots__ = ()

    @property
    def level(self) -> str | None:
        """Level that the measurements confirm: "good", "inside_sampled_range" or "do_not_use"; None if the calibration has no bounds to test."""
        return self._maybe(str, "verdict", "level")

    @property
    def reasons(self) -> list[str]:
        """Reasons against a better verdict, a sentence each."""
        return self._texts("verdict", "reasons")

    @property
    def fitted(self) -> list[str]:
        """Files from which the calibration itself was made: it fits them better than new ones."""
        return self._texts("fitted")

    @property
    def model(self) -> str:
        """The delivered model: "corrected" if it has terms, else "calibrated"."""
        return self._at(str, "verdict", "model")

    @property
    def count(self) -> int:
        """Number of rows."""
        return self._at(int, "count")

    @property
    def position_rms_mm(self) -> float | None:
        """Error of position (RMS), millimetres; None if no position was measured."""
        return self._maybe(float, "verdict", "position_mm", "rms")

    @property
    def position_max_mm(self) -> float | None:
        """Largest error of position, millimetres."""
        return self._maybe(float, "verdict", "position_mm", "max")

    @property
    def expected_rms_mm(self) -> float | None:
        """Expected error of position (RMS), measurement noise included, millimetres."""
        return self._maybe(float, "verdict", "position_mm", "expected_rms")

    @property
    def rotation_rms_deg(self) -> float | None:
        """Error of orientation (RMS), degrees; None if no orientation was measured."""
        return self._maybe(float, "verdict", "rotation_deg", "rms")

    @property
    def inside_bound95(self) -> float | None:
        """Share of the errors of position within their own 95 % bound, from 0 to 1."""
        return self._maybe(float, "verdict", "position_mm", "inside_bound95")

    @property
    def refitted(self) -> list[str]:
        """Parts that were fitted to these measurements: the device's frame, the tool."""
        return self._texts("refitted")

    @property
    def accepted(self) -> bool | None:
        """True if the limits of `accept` are shown to be kept; None without limits."""
        decision = self._maybe(str, "acceptance", "decision")
        return None if decision is None else decision == "pass"

    def _rows(self) -> list[dict[str, Any]]:
        corrected = self.get("corrected") or {}
        models: dict[str, Mapping[str, Any] | None] = {
            "nominal": self["nominal"],
            "calibrated": self["calibrated"],
            "corrected": {key: part for key, part in corrected.items() if isinstance(part, dict) and "rms" in part},
        }
        return [
            {"model": model, "quantity": quantity, **part}
            for model, found in models.items()
            for quantity, part in (found or {}).items()
            if isinstance(part, dict)
        ]


class Visit(Findings):
    """Detection of a robot's change: the result of `track`. Its data frame has a row for each joint, with its detectable shift."""

    __slots__ = ()

    @property
    def state(self) -> str:
        """The state of the robot: "unchanged" or "changed"."""
        return self._at(str, "state")

    @property
    def changed(self) -> bool:
        """True if more changed than noise explains."""
        return self.state == "changed"

    @property
    def explanation(self) -> str | None:
        """The simplest sufficient explanation, in words; None if nothing changed."""
        return self._maybe(str, "explanation", "words")

    @property
    def joint(self) -> str | None:
        """The joint that explains the change; None if the explanation concerns no joint."""
        return self._maybe(str, "explanation", "joint")

    @property
    def size_deg(self) -> float | None:
        """Turn of that joint, degrees."""
        return self._maybe(float, "explanation", "size_deg")

    @property
    def size_mm(self) -> float | None:
        """Motion of that joint, millimetres."""
        return self._maybe(float, "explanation", "size_mm")

    @property
    def change_mm(self) -> float:
        """Change of the measured positions beside the free unknowns (RMS), millimetres."""
        return self._at(float, "change_mm")

    @property
    def noise_mm(self) -> float:
        """Standard deviation of a coordinate of such a change, millimetres."""
        return self._at(float, "noise_mm")

    @property
    def error_mm(self) -> float:
        """Error of the delivered model at this visit (RMS), millimetres."""
        return self._at(float, "error_mm")

    @property
    def unseen(self) -> list[str]:
        """Names of the joints whose zeros these rows do not determine."""
        return [joint["joint"] for joint in self["invisible"]]

    def _rows(self) -> list[dict[str, Any]]:
        return list(self["joints"])


class VisitPlan(Findings):
    """Configurations for visits to a calibrated robot: the result of `plan` with `purpose="drift"`.

    Its data frame is the table to fill in. It adds `rows` and `table` to the program's output with `--json`.
    """

    __slots__ = ()

    @property
    def joints(self) -> NDArray[np.float64]:
        """The configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`."""
        array: NDArray[np.float64] = imported("numpy").array([row["readings"] for row in self["rows"]], dtype=float)
        return array

    @property
    def smallest_deg(self) -> dict[str, float | None]:
        """The smallest shift of each turning joint's zero that a visit would detect (95 %), degrees; None if it detects none."""
        return {joint["joint"]: joint["smallest"] for joint in self["joints"] if joint["unit"] == "deg"}

    @property
    def smallest_mm(self) -> dict[str, float | None]:
        """The smallest shift of each sliding joint's zero that a visit would detect (95 %), millimetres; None if it detects none."""
        return {joint["joint"]: joint["smallest"] for joint in self["joints"] if joint["unit"] == "mm"}

    @property
    def unseen(self) -> list[str]:
        """Names of the joints whose zeros a visit would not determine."""
        return [joint["joint"] for joint in self["invisible"]]

    @property
    def noise_mm(self) -> float:
        """Standard deviation of a visit and coordinate for which this holds, millimetres."""
        return self._at(float, "noise_mm")

    def to_dataframe(self) -> _pandas.DataFrame:
        """The table to fill in as a data frame of pandas, which has to be installed.

        Returns
        -------
        pandas.DataFrame
            A row for each measurement: `id`, the readings in degrees and millimetres, and empty columns for the measured quantities.
        """
        return table(self._at(str, "table"))

    def write(self, path: str | PathLike[str], *, force: bool = False) -> None:
        """Writes the table to fill in.

        Parameters
        ----------
        path
            The file (CSV).
        force
            True to overwrite a file that exists.
        """
        from ._poecal import _write_text

        _write_text(path, self._at(str, "table"), force)
