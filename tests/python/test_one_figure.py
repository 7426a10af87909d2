"""One figure for one question: verdict, table, limits, report and predictions are about one model and its expected error, for the example and
eight real sessions.
"""

import csv
import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
from program import ELBOW, ROOT, poecal

REAL = Path(os.environ.get("POECAL_DATASETS", "nowhere"))
SESSIONS = {
    "elbow": (ELBOW, ROOT / "examples/elbow/points.csv"),
    "UR10, grid": (REAL / "ur10_tmac/robot.urdf", REAL / "ur10_tmac/series_A.csv"),
    "UR10, random": (REAL / "ur10_tmac/robot.urdf", REAL / "ur10_tmac/series_C.csv"),
    "IRB 120": (REAL / "irb120_faro/robot.urdf", REAL / "irb120_faro/points.csv"),
    "MA1400": (REAL / "motoman/robot_left_leica.urdf", REAL / "motoman/points_left_small.csv"),
    "Meca500": (REAL / "meca500/robot.urdf", REAL / "meca500/large160.csv"),
    "positioner": (REAL / "positioner_2axis/robot.urdf", REAL / "positioner_2axis/poses.csv"),
    "column, flat": (REAL / "hilti_column_arm/trailblazer.urdf", REAL / "hilti_column_arm/flat.csv", "--tip-link", "prism"),
    "column, pallet": (REAL / "hilti_column_arm/trailblazer.urdf", REAL / "hilti_column_arm/pallet.csv", "--tip-link", "prism"),
}


def shown(value: float) -> str:
    """A figure of the table: four decimals below ten, three below a hundred."""
    digits = min(max(3 - int(np.floor(np.log10(value))), 1), 4)
    return f"{value:.{digits}f}"


@pytest.mark.parametrize("name", SESSIONS)
def test_one_figure_for_one_question(name, tmp_path):
    model, measurements, *options = SESSIONS[name]
    if not model.is_file():
        pytest.skip("the data sets are not here: set POECAL_DATASETS")
    out = tmp_path / "out"
    table = poecal("calibrate", model, measurements, *options, "--accept", "100mm", "--out", out)
    file = json.loads((out / "calibration.json").read_text())
    verdict, corrected = file["verdict"], file["corrected"]
    has_terms = any(size > 0 for size in corrected["sizes"].values())
    assert verdict["model"] == ("corrected" if has_terms else "calibrated") == file["acceptance"]["model"]
    own = corrected["uncertainty"] if has_terms else file["uncertainty"]
    expected = verdict["expected_error_mm"]
    # The table, in its words and figures, and the report by its keys.
    line = re.search(r"^expected +([0-9.]+) mm \(RMS\) near measured configurations, 95 % below ([0-9.]+)\s+mm(;|$)", table, re.M)
    assert line and (line[1], line[2]) == (shown(expected), shown(verdict["bound95_mm"])), table
    after = re.search(r"^after +.* \(RMS\)\s+on\s+rows\s+held\s+out:\s+(\w+)\s+model$", table, re.M)
    assert after and after[1] == verdict["model"], table
    page = (out / "report.html").read_text()
    assert re.search(rf"after, on rows held out: {verdict['model']}\s+model", page) and page.count('data-key="verdict.expected_error_mm"') == 1
    assert expected == own["measured"]["sigma_position_mm"]
    # Predictions in the configurations that were measured, of every target.
    predicted = []
    for target in sorted(file["targets"]):
        text = poecal("predict", out / "calibration.json", measurements, "--with-uncertainty", "--target", target)
        rows = list(csv.DictReader(text.splitlines()))
        predicted += [1e3 * float(row["sigma_position[m]"]) for row in rows if row["inside_sampled_range"] == "true"]
    rms = float(np.sqrt(np.mean(np.square(predicted))))
    left_out = corrected.get("left_out_position_mm") if has_terms else file["cross_validation"]["random"]["rms"]["position_mm"]
    print(f"{name}: {verdict['model']}, expected {expected:.4f} mm, predictions {rms:.4f} mm, cross-validation {left_out:.4f} mm")
    # The expected error is a mean over 400 fitted rows at most, and predictions are of held-out rows too.
    assert abs(rms / expected - 1) < 0.05
    # The file has six decimals of the share that terms leave.
    assert expected >= 0.9 * left_out * (1 - 1e-5)
    # Without terms, both models are one.
    if not has_terms:
        both = [poecal("predict", out / "calibration.json", measurements, "--with-uncertainty", "--model", it) for it in ["corrected", "calibrated"]]
        assert both[0] == both[1]
