"""Calibrations of real measured robots, if the data sets are available; and a test that their judgement detects errors."""

import json
import runpy
import statistics
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SKIPPED = 77
SCRIPT = runpy.run_path(str(ROOT / "validation" / "run"))
EXPECTED = json.loads((ROOT / "validation" / "expected.json").read_text(encoding="utf-8"))
FIGURES = [(case, figure) for case in EXPECTED["constraints"] for figure in case["figures"]]
CASES = pytest.mark.parametrize("case", EXPECTED["cases"], ids=lambda case: case["name"])


def test_real_robots_reach_their_figures():
    done = subprocess.run([sys.executable, ROOT / "validation" / "run", "--check"], capture_output=True, text=True)
    print(done.stdout, done.stderr)
    if done.returncode == SKIPPED:
        pytest.skip(done.stdout.strip())
    assert done.returncode == 0, done.stderr


def figures(case):
    """Figures of a run of the case that are exactly as good as expected."""
    return {
        "registered": case["registered_mm"],
        "calibrated": case["calibrated_mm"],
        "mrad": case["calibrated_mrad"],
        "quantiles": case["held_out_mm"],
        "held_out": 400,
        "corrected": case["corrected_mm"],
        "inside": 0.95,
        "corrected_inside": 0.95,
        "iterations": 5,
    }


@CASES
def test_what_is_expected_is_missed_by_nothing_and_by_whatever_is_worse(case):
    judge, tolerance = SCRIPT["judge"], EXPECTED["tolerance"]
    good = figures(case)
    assert judge(case, good, tolerance) == []
    # 2 % and, of quantiles of 400 rows, 5 % more.
    worse = {"inside": 0.8, "corrected_inside": 0.8, "iterations": 201}
    for name in ("registered", "calibrated", "corrected", "mrad"):
        if good[name]:
            worse[name] = 1.03 * good[name]
    for name, value in worse.items():
        assert len(judge(case, {**good, name: value}, tolerance)) == 1, name
    for name, value in good["quantiles"].items():
        spread = {**good["quantiles"], name: 1.08 * value}
        assert len(judge(case, {**good, "quantiles": spread}, tolerance)) == 1, name


@CASES
def test_expected_quantiles_are_those_of_the_expected_mean(case):
    median, upper, most, largest = (case["held_out_mm"][name] for name in SCRIPT["SHARES"])
    assert 0 < median < upper < most < largest
    # The mean of errors that are at most these in each part, and at least those before.
    if case["calibrated_mm"]:
        least = 0.25 * median + 0.2 * upper + 0.05 * most
        assert least < case["calibrated_mm"] < 0.5 * median + 0.25 * upper + 0.2 * most + 0.05 * largest


@pytest.mark.parametrize(("case", "figure"), FIGURES, ids=lambda it: it.get("name") or it["words"])
def test_a_bound_is_missed_by_its_model_and_those_after_it(case, figure):
    judge, models, tolerance = SCRIPT["judge_constraint"], SCRIPT["MODELS"], EXPECTED["tolerance"]
    most = figure.get("at_most", 1)
    good = {"registered": 3 * most, "calibrated": most, "corrected": most}
    assert judge(figure, good, tolerance) == []
    assert len(judge(figure, {**good, "calibrated": 0.9 * most}, tolerance)) == 1
    if "judged" in figure:
        assert {"model", "measurements", "options", "source", "sha256"} <= case.keys()
        for model in models[models.index(figure["judged"]) :]:
            assert len(judge(figure, {**good, model: 1.001 * most}, tolerance)) == 1, model


def test_a_figure_of_one_target_is_that_of_its_rows():
    rows = [{"target": target, **{f"position_{model}[mm]": value for model in SCRIPT["MODELS"]}} for target, value in (("A", "3"), ("B", "9"), ("A", "4"))]
    figure = {"of": "position_mm", "statistic": "rms", "target": "A"}
    assert SCRIPT["constraint_figure"]({}, rows, figure)["corrected"] == pytest.approx(12.5**0.5)
    assert SCRIPT["constraint_figure"]({}, rows, {**figure, "statistic": "mean"})["calibrated"] == pytest.approx(3.5)


def test_quantiles_are_those_of_the_standard_library():
    errors = sorted((37 * k % 101) ** 1.5 for k in range(100))
    found = SCRIPT["quantiles"](errors)
    hundredths = statistics.quantiles(errors, n=100, method="inclusive")
    expected = [statistics.median(errors), hundredths[74], hundredths[94], max(errors)]
    assert list(found.values()) == pytest.approx(expected, rel=1e-12)
