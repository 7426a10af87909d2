"""Pictures of a calibration, by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ._errors import PackageError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

    from ._poecal import Calibration

try:
    import matplotlib.pyplot as plt
except ModuleNotFoundError as error:
    raise PackageError("found no package `matplotlib`, expected it to be installed: pip install matplotlib") from error

SETS = [("fitted", False, "tab:blue", "."), ("held out", True, "tab:orange", "x")]


def plot(calibration: Calibration, axes: Sequence[Axes] | None = None) -> Figure | SubFigure:
    """Draws errors of position into two axes, and gives their figure."""
    if axes is None:
        figure, axes = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
        # Notebooks would show it twice, as a figure that is open and as a result.
        plt.close(figure)
    errors, rows = axes
    residuals = calibration.residuals
    held_out = residuals.held_out
    judged, name = (held_out, "held-out") if held_out.any() else (~held_out, "fitted")
    models = [
        ("nominal, tool and device fitted", residuals.position_registered_mm, "0.5"),
        ("calibrated", residuals.position_calibrated_mm, "tab:orange" if held_out.any() else "tab:blue"),
    ]
    share = 100 * np.arange(1, judged.sum() + 1) / judged.sum()
    for label, values, colour in models:
        errors.step(np.sort(values[judged]), share, where="post", label=label, color=colour)
    errors.set(xscale="log", xlabel="error of position, mm", ylabel="% of the rows, at most this error", ylim=(0, 103))
    errors.set_title(f"{calibration.robot.name}: {judged.sum()} {name} rows")
    errors.legend(loc="upper left")

    index = np.arange(len(residuals))
    for label, of_set, colour, marker in SETS:
        chosen = held_out == of_set
        if chosen.any():
            rows.plot(index[chosen], residuals.position_calibrated_mm[chosen], marker, color=colour, label=label)
    if residuals.suspected.any():
        suspected = residuals.suspected
        rows.plot(index[suspected], residuals.position_calibrated_mm[suspected], "o", mfc="none", color="tab:red", label="suspected")
    rows.set(xlabel="row", ylabel="error of position, mm", ylim=(0, None), title="calibrated, row by row")
    rows.legend()
    for each in (errors, rows):
        each.grid(True, alpha=0.3)
    return errors.figure
