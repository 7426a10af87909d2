"""The stubs of the package agree with it, and code that uses it is well typed."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from program import ROOT
from snippets import blocks

EXAMPLES = sorted((ROOT / "examples/python").glob("*.py"))
SCALE = sorted((ROOT / "examples/scale").glob("*.py"))
CACHE = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "mypy"
CHECKS = {
    "stubs": ["mypy.stubtest", "poecal"],
    "package": ["mypy", "--strict", "-p", "poecal"],
    # Packages that an example needs may be absent, or without types.
    "examples": ["mypy", "--strict", "--ignore-missing-imports", "--scripts-are-modules", *EXAMPLES],
    # Ray and Dask have functions without types.
    "scale": ["mypy", "--strict", "--allow-untyped-calls", "--ignore-missing-imports", "--scripts-are-modules", *SCALE],
    "benches": ["mypy", "--strict", "--scripts-are-modules", *sorted((ROOT / "crates/poecal-py/benches").glob("*.py"))],
}
# Usages that users may write, with their types.
USE = """
import matplotlib.pyplot as plt
import numpy as np
import poecal
from matplotlib.figure import Figure
from numpy.typing import NDArray

robot = poecal.Robot.read("robot.urdf")
rows = poecal.Measurements.from_csv(["a.csv", "b.csv"], robot)
calibration = poecal.calibrate(robot, rows, seed=3, tolerance_deg_mm=None)
joints = np.zeros((3, 6))
poses: NDArray[np.float64] = calibration.predict(joints)
same: NDArray[np.float64] = calibration.predict(joints, with_uncertainty=False, output_frame="device")
found: poecal.Prediction = calibration.predict(joints, with_uncertainty=True)
flag = len(rows) > 3
either: NDArray[np.float64] | poecal.Prediction = calibration.predict(joints, with_uncertainty=flag)
level: str = calibration.verdict.level
parts: list[poecal.Measurements] = [rows[1:3], rows[-1], rows[[1, 2]], rows[joints[:, 0] > 0], rows[np.array([1, 2])], rows + rows]
each: list[poecal.Measurements] = [row for row in rows]
table: dict[str, list[float]] = {"joint1[deg]": [1.0]}
columns = poecal.Measurements.from_dataframe(table, robot)
mixed = poecal.Measurements.from_dataframe({"joint1": joints[:, 0], "target": ["a", "b", "c"]}, robot)
fields = poecal.Measurements.from_dataframe(np.zeros(3, dtype=[("joint1", float)]), robot)
figure: Figure = calibration.plot()
drawn, axes = plt.subplots(1, 2)
calibration.plot(axes)
residuals: NDArray[np.float64] = calibration.residuals.position_mm
names: list[str] = calibration.covariance.names
offsets: poecal.Offsets = poecal.offsets(robot, calibration)
degrees: dict[str, float] = offsets.offsets_deg
judged: poecal.Validation = calibration.validate(rows)
error: float | None = judged.position_rms_mm
whole: object = judged["verdict"]
planned: poecal.Plan = poecal.plan(robot, count=8, floor_height_mm="-70cm", margin_deg_mm=(5, "1cm"))
test: poecal.TestPlan = poecal.plan(robot, purpose="iso9283", workspace_box_mm=[[700, -100, 400], [900, 100, 400]])
visit: poecal.VisitPlan = poecal.plan(calibration, purpose="drift", device="known", repeatability_mm=0.03)
found_again: list[poecal.Findings] = [offsets, judged, visit, poecal.check(robot), poecal.track(calibration, rows)]
in_texts = poecal.calibrate("robot.urdf", "points.csv", sigma_position_mm="0.05mm", tolerance_deg_mm="0.5deg,5mm", corrections={"sag": "0.05deg"})
summary: poecal.Compensation = calibration.compensate(joints, summary=True, max_turn_deg=2)[1]
"""


def mypy(arguments, folder):
    command = [sys.executable, "-m", *map(str, arguments)]
    # The parsed types of NumPy and others serve the next check too.
    cache = {"MYPY_CACHE_DIR": str(CACHE)}
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=os.environ | cache)
    assert run.returncode == 0, run.stdout + run.stderr


def pyright() -> str:
    """The program, in PATH, or as npm installs it in web/."""
    in_web = ROOT / "web/node_modules/.bin/pyright"
    found = shutil.which("pyright") or (str(in_web) if in_web.exists() else shutil.which("basedpyright"))
    if not found and os.environ.get("CI") == "true":
        pytest.fail("found no pyright, which ./test installs into web/node_modules")
    return found or pytest.skip("found no pyright, neither in PATH nor in web/node_modules")


@pytest.mark.parametrize("check", CHECKS)
def test_types_are_right(check, tmp_path):
    mypy(CHECKS[check], tmp_path)


def test_what_users_write_is_well_typed(tmp_path):
    (tmp_path / "use.py").write_text(USE)
    mypy(["mypy", "--strict", "use.py"], tmp_path)


@pytest.mark.parametrize("page", ["README.md", "crates/poecal-py/README.md", "docs/python.md"])
def test_what_pages_show_is_well_typed(page, tmp_path):
    """A page's blocks in sequence, as a reader would copy them."""
    text = "\n".join(block.text for block in blocks(ROOT / page) if block.language == "python")
    assert "import poecal" in text
    (tmp_path / "page.py").write_text(text)
    # numpy.ma has types from NumPy 2.3 on, which Python 3.10 does not get.
    older = ["--allow-untyped-calls"] if np.lib.NumpyVersion(np.__version__) < "2.3.0" else []
    mypy(["mypy", "--strict", *older, "page.py"], tmp_path)


def test_pyright_agrees(tmp_path):
    (tmp_path / "use.py").write_text(USE)
    (tmp_path / "pyrightconfig.json").write_text(json.dumps({"typeCheckingMode": "standard"}))
    program = pyright()
    # It searches packages where the first `python` of PATH does.
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    for arguments in [["use.py"], ["--verifytypes", "poecal", "--ignoreexternal"]]:
        run = subprocess.run([program, *arguments], cwd=tmp_path, capture_output=True, text=True, env=environment)
        assert run.returncode == 0, run.stdout + run.stderr


def test_stubs_have_the_docstrings_of_the_module():
    sys.path.insert(0, str(ROOT / "scripts/docs"))
    from stubs import STUBS, with_docstrings

    from poecal import _poecal

    text = STUBS.read_text(encoding="utf-8")
    assert text.count('"""') > 200
    assert with_docstrings(text, _poecal) == text, "`python scripts/docs/stubs.py`, with the package installed, writes them"
