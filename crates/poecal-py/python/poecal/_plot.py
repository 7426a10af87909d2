"""Pictures of a calibration, by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from ._errors import OptionError, missing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ._poecal import Calibration

SETS = [("fitted", False, "tab:blue", "."), ("held out", True, "tab:orange", "x")]


def plot(calibration: Calibration, axes: Sequence[Axes] | NDArray[Any] | None = None) -> Figure:
    """Draws errors of the delivered model in the leading quantity (for poses and points the position) into two axes, and returns their figure."""
    try:
        import matplotlib.pyplot as plt
        from matplotlib.axes import Axes
    except ModuleNotFoundError as error:
        raise missing("matplotlib") from error
    if axes is None:
        figure, axes = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
        # Notebooks would show it twice, as a figure that is open and as a result.
        plt.close(figure)
    given = list(axes.flat) if isinstance(axes, np.ndarray) else axes
    if not isinstance(given, list | tuple) or len(given) != 2 or not all(isinstance(each, Axes) for each in given):
        raise OptionError(f"axes: found {type(axes).__name__}, expected two axes of matplotlib, as of plt.subplots(1, 2)")
    errors, rows = given
    residuals = calibration.residuals
    held_out = residuals.held_out
    judged, name = (held_out, "held-out") if held_out.any() else (~held_out, "fitted")
    quantity, unit = next(iter(residuals.quantities.items()))
    model = residuals.model
    delivered = residuals.errors(quantity)
    models = [
        ("your model, tool and device located", residuals.errors(quantity, model="registered"), "0.5"),
        (model, delivered, "tab:orange" if held_out.any() else "tab:blue"),
    ]
    judged = judged & ~np.isnan(delivered)
    share = 100 * np.arange(1, judged.sum() + 1) / judged.sum()
    for label, values, colour in models:
        errors.step(np.sort(values[judged]), share, where="post", label=label, color=colour)
    errors.set(xscale="log", xlabel=f"error of {quantity}, {unit}", ylabel="% of the rows with at most this error")
    errors.set_title(f"{calibration.robot.name}: {judged.sum()} {name} rows")
    errors.xaxis.set_major_formatter("{x:g}")
    # Room for the legends above the largest.
    errors.set(ylim=(0, 118), yticks=range(0, 101, 20))
    errors.legend(loc="upper right", ncols=len(models))

    index = np.arange(len(residuals))
    for label, of_set, colour, marker in SETS:
        chosen = held_out == of_set
        if chosen.any():
            rows.plot(index[chosen], delivered[chosen], marker, color=colour, label=label)
    if residuals.suspected.any():
        suspected = residuals.suspected
        rows.plot(index[suspected], delivered[suspected], "o", mfc="none", color="tab:red", label="suspected")
    rows.set(xlabel="row", ylabel=f"error of {quantity}, {unit}", ylim=(0, 1.2 * rows.get_ylim()[1]), title=f"{model}, row by row")
    rows.legend(loc="upper right", ncols=len(SETS) + 1)
    for each in (errors, rows):
        each.grid(True, alpha=0.3)
    return cast("Figure", errors.get_figure(root=True))
