"""Results about sessions, cameras, tools and programs, with the important numbers as attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._findings import Findings, imported

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Identification(Findings):
    """Unknowns that configurations determine, and the expected errors: the result of `identify`. Its data frame has a row for each joint."""

    __slots__ = ()

    @property
    def determined(self) -> int:
        """Number of unknowns that are determined."""
        return self._at(int, "identifiability", "rank")

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return self._at(int, "identifiability", "parameters")

    @property
    def weak(self) -> list[str]:
        """Weakly determined directions, a sentence each."""
        return [found["description"] for found in self["identifiability"]["weak"]]

    @property
    def undetermined(self) -> list[str]:
        """Undetermined directions, a sentence each."""
        return [found["description"] for found in self["identifiability"]["unidentifiable"]]

    @property
    def expected_calibrated_mm(self) -> float | None:
        """Expected error of the calibrated model (RMS), millimetres; None for kinds whose configurations cannot be chosen freely."""
        return self._maybe(float, "expected", "calibrated_mm")

    @property
    def expected_corrected_mm(self) -> float | None:
        """Expected error of the corrected model (RMS), millimetres."""
        return self._maybe(float, "expected", "corrected_mm")

    def _rows(self) -> list[dict[str, Any]]:
        return list(self["coverage"])


class WatchedRow(Findings):
    """A row of a session that is watched: the result of `Watch.add`. Its data frame has one row."""

    __slots__ = ()

    @property
    def row(self) -> int:
        """Number of the row, from 1."""
        return self._at(int, "row")

    @property
    def ok(self) -> bool | None:
        """True if the row is as expected; None while there are too few rows."""
        return self._maybe(bool, "ok")

    @property
    def mistake(self) -> str | None:
        """Mistake of the row: "stale", "sign", "joint", "off", "repeats" or "moved"; None if there is none."""
        return self._maybe(str, "mistake")

    @property
    def noticed_mm(self) -> float | None:
        """The smallest detectable error, millimetres."""
        return self._maybe(float, "noticed_mm")

    @property
    def expected_calibrated_mm(self) -> float | None:
        """Expected error of the calibrated model now (RMS), millimetres."""
        return self._maybe(float, "expected_calibrated_mm")

    @property
    def expected_corrected_mm(self) -> float | None:
        """Expected error of the corrected model now (RMS), millimetres."""
        return self._maybe(float, "expected_corrected_mm")

    @property
    def next(self) -> NDArray[np.float64] | None:
        """The configuration that gains most, shape (n,), radians and metres."""
        found = self._maybe(list, "next")
        return None if found is None else imported("numpy").array(found, dtype=float)


class Iso9283(Findings):
    """A test after ISO 9283: the result of `iso9283`. Its data frame has a row for each figure and pose."""

    __slots__ = ()

    @property
    def ap_mm(self) -> float:
        """The largest pose accuracy of positions, millimetres."""
        return self._largest("AP")

    @property
    def rp_mm(self) -> float:
        """The largest pose repeatability of positions, millimetres."""
        return self._largest("RP")

    @property
    def accepted(self) -> bool | None:
        """True if all limits are shown to be kept, with 95 % confidence; None without limits."""
        decision = self._maybe(str, "decision")
        return None if decision is None else decision == "pass"

    def _largest(self, symbol: str) -> float:
        return max(float(it["found"]) for it in self["figures"] if it["figure"] == symbol)

    def _rows(self) -> list[dict[str, Any]]:
        return list(self["figures"])


class Judged(Findings):
    """A result with a verdict."""

    __slots__ = ()

    @property
    def level(self) -> str:
        """Judgement of the result: "good", or the level up to which it may be used."""
        return self._at(str, "verdict", "level")

    @property
    def reasons(self) -> list[str]:
        """Reasons against a better level, a sentence each."""
        return self._texts("verdict", "reasons")


class HandEye(Judged):
    """Pose of a camera: the result of `hand_eye`. Its data frame has a row for each of both frames."""

    __slots__ = ()

    @property
    def camera_pose(self) -> NDArray[np.float64]:
        """Pose of the camera in the flange, or in the base if it is beside the robot, shape (4, 4), metres."""
        pose: NDArray[np.float64] = imported("numpy").array(self["camera_frame"]["matrix"], dtype=float)
        return pose

    @property
    def bound95_mm(self) -> float:
        """Bound of the camera's position error in 95 % of all cases, millimetres."""
        return self._at(float, "camera_frame", "bound95_mm")

    @property
    def bound95_deg(self) -> float:
        """Bound of the camera's direction error in 95 % of all cases, degrees."""
        return self._at(float, "camera_frame", "bound95_deg")

    def _rows(self) -> list[dict[str, Any]]:
        return [self["camera_frame"], self["target_frame"]]


class ToolTip(Judged):
    """Position of a tool's tip: the result of `tcp`. Its data frame has a row for each tip."""

    __slots__ = ()

    @property
    def position_m(self) -> NDArray[np.float64]:
        """Position of the tip in the flange, for several the first, shape (3,), metres."""
        place: NDArray[np.float64] = imported("numpy").array(self["tips"][0]["position_m"], dtype=float)
        return place

    @property
    def bound95_mm(self) -> float:
        """Bound of the tip's position error in 95 % of all cases, millimetres."""
        bound: float = self["tips"][0]["bound95_mm"]
        return bound

    @property
    def outliers(self) -> list[str]:
        """Touches that are left out as wrong."""
        return self._texts("outliers")

    def _rows(self) -> list[dict[str, Any]]:
        return list(self["tips"])


class Compensation(Findings):
    """Corrections in a program or in joint readings: the summary of `Calibration.compensate` and `compensate_program`.

    Its data frame has a row for each target that is corrected.
    """

    __slots__ = ()

    @property
    def count(self) -> int:
        """Number of targets that are corrected."""
        return self._at(int, "rows")

    @property
    def left_out(self) -> list[str]:
        """Unchanged targets, with the line and the reason."""
        return [f"line {it['line']}: {it['reason']}" for it in self["listed"]]

    @property
    def off_max_mm(self) -> float:
        """Largest error of the tip without correction, millimetres."""
        return 1e3 * self._at(float, "moved_m", "value")

    @property
    def left_max_mm(self) -> float:
        """Largest error of the tip with the correction, by the calibrated model, millimetres."""
        return 1e3 * self._at(float, "left_m", "value")

    def _rows(self) -> list[dict[str, Any]]:
        return list(self.get("targets") or [])


class Reproduction(Findings):
    """The experiment of a paper: the result of `reproduce`. Its data frame has a row for each claim, or for each loss and share of gross errors."""

    __slots__ = ()

    @property
    def holding(self) -> int | None:
        """Number of the paper's claims that hold; None for "breakdown"."""
        claims = self.get("claims")
        return None if claims is None else sum(claim["holds"] and claim["said_by_paper"] for claim in claims)

    def _rows(self) -> list[dict[str, Any]]:
        return list(self.get("claims") or self.get("entries") or [])
