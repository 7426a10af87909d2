"""The examples of docs/scale.md: the same bytes in one process and by several, also if one of these is killed.

Ray and Dask run on this machine, on 127.0.0.1 alone. `POECAL_TRIALS=weekly` is 100,000 fits and 1,000 robots, which take ten
minutes; without it a fiftieth is made, whose bytes are compared alike, and whose spread is judged with the larger scatter of fewer fits.
"""

import csv
import filecmp
import os
import signal
import subprocess
import sys
import time
import uuid
from pathlib import Path

import pytest
from program import ROOT

pytest.importorskip("poecal")

SCALE = ROOT / "examples/scale"
MODULES = {"ray": "ray.data", "dask": "dask.distributed"}
WORKERS = 2
# A variable that all processes of a run inherit, by which what it has left is found.
MARK = "POECAL_TEST_RUN"


def trials(weekly: int, least: int) -> int:
    words = {"": weekly // 50, "quick": weekly // 100, "weekly": weekly, "full": 100 * weekly}
    asked = os.environ.get("POECAL_TRIALS", "")
    return max(words[asked] if asked in words else int(asked), least)


# Fits of the runs that are compared byte by byte, in ten chunks each, and of the large one, whose chunks are as large as these runs.
FITS = trials(100_000, 1000) // 100 * 10
ROBOTS = trials(1000, 20)


def left(run: str) -> list[int]:
    """Processes that a run has left, if the system reports them."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if f"{MARK}={run}".encode() in (place / "environ").read_bytes().split(b"\0"):
                found.append(int(place.name))
        except OSError:
            continue
    return found


def run(script: str, *arguments: object, seconds: float = 2400, code: int = 0) -> str:
    """Runs an example; it has to end with this code, and all its processes with it. Returns its output for people."""
    name = uuid.uuid4().hex
    command = [sys.executable, str(SCALE / script), *map(str, arguments)]
    start = time.monotonic()
    try:
        done = subprocess.run(command, env={**os.environ, MARK: name}, capture_output=True, text=True, timeout=seconds)
        print(f"{' '.join(map(str, (script, *arguments)))}: {time.monotonic() - start:.1f} s\n{done.stdout}")
        assert done.returncode == code, done.stdout + done.stderr
        # Servers of Ray may take a moment to notice the end of their parent.
        until = time.monotonic() + 30
        while left(name) and time.monotonic() < until:
            time.sleep(0.1)
        assert left(name) == [], "processes are left"
        return done.stderr
    finally:
        for process in left(name):
            os.kill(process, signal.SIGKILL)


def by(engine: str) -> list[object]:
    """Options for several processes, one of which is killed."""
    pytest.importorskip(MODULES[engine], reason=f"found no {engine}: its part of docs/scale.md is not tested")
    return ["--engine", engine, "--workers", WORKERS, "--kill-one"]


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def assert_same(folder: Path, other: Path) -> None:
    """The same files with the same bytes, at any depth."""
    names = [sorted(path.relative_to(it).as_posix() for path in it.rglob("*") if path.is_file()) for it in (folder, other)]
    assert names[0] == names[1] != []
    _, different, failed = filecmp.cmpfiles(folder, other, names[0], shallow=False)
    assert different == failed == []


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Fits in one process."""
    folder = tmp_path_factory.mktemp("monte-carlo") / "alone"
    run("monte_carlo.py", "--trials", FITS, "--chunk", FITS // 10, "--out", folder)
    return folder


@pytest.mark.parametrize("engine", MODULES)
def test_a_monte_carlo_run_has_the_same_bytes_by_several_processes(engine, alone, tmp_path):
    said = run("monte_carlo.py", "--trials", FITS, "--chunk", FITS // 10, "--out", tmp_path / engine, *by(engine))
    assert "was killed on the way" in said
    assert_same(alone, tmp_path / engine)


def test_stated_uncertainties_are_true(alone, tmp_path):
    """Many fits, in large chunks."""
    count = 10 * FITS
    # Two processes are worth their start if there is much to do.
    run("monte_carlo.py", "--trials", count, "--chunk", FITS, "--out", tmp_path / "large", *(by("ray") if count > 10_000 else []))
    chunks = rows(tmp_path / "large/chunks.csv")
    assert len(chunks) == 10 and sum(int(row["fits"]) for row in chunks) == count
    # The first tenth, which one process has computed in smaller chunks.
    parts = rows(alone / "chunks.csv")
    for what, value in chunks[0].items():
        if what.endswith(("fits", "failed", "count", "inside")):
            assert int(value) == sum(int(row[what]) for row in parts), what
        elif what.endswith("2"):
            # Only the order of the sums differs: of 10,000 roundings.
            assert float(value) == pytest.approx(sum(float(row[what]) for row in parts), rel=1e-12)
    found = rows(tmp_path / "large/spread.csv")
    assert len(found) == 25
    scatter = (0.95 * 0.05 / count) ** 0.5
    for row in found:
        # 100,000 trials showed 0.16 % and, of the axes, 1.1 % (the prior is included, and moves little), 3.3 % of the tip (whose bound includes
        # errors of the model too). Half more, and four standard errors of the number of trials.
        assert abs(float(row["inside"]) - 0.95) < 0.0025 + 4 * scatter, row
        excess = 0.05 if row["what"] == "tip" else 0.017
        assert float(row["off"]) == pytest.approx(float(row["stated"]), rel=excess + 4 / (2 * count) ** 0.5), row


def test_a_cluster_gets_model_and_functions_with_the_tasks(tmp_path):
    """Its processes have the package, and nothing of the examples."""
    pytest.importorskip(MODULES["dask"], reason="found no dask: its part of docs/scale.md is not tested")
    from dask.distributed import LocalCluster

    several = ["--trials", 200, "--chunk", 50]
    run("monte_carlo.py", *several, "--out", tmp_path / "alone")
    place = {"n_workers": 1, "threads_per_worker": 1, "host": "127.0.0.1", "dashboard_address": None}
    with LocalCluster(**place, local_directory=tmp_path / "dask") as cluster:
        run("monte_carlo.py", *several, "--out", tmp_path / "cluster", "--engine", "dask", "--address", cluster.scheduler_address)
    assert_same(tmp_path / "alone", tmp_path / "cluster")


@pytest.fixture(scope="module")
def robots(tmp_path_factory):
    """Simulated robots, of which two have broken files, and their calibrations in one process."""
    folder = tmp_path_factory.mktemp("folder")
    run("folder.py", folder / "robots", "--make", ROBOTS)
    (folder / "robots/robot00007/measurements.csv").write_text("joint1,joint2\n1,2\n")
    (folder / "robots/robot00010/robot.urdf").unlink()
    run("folder.py", folder / "robots", "--out", folder / "alone")
    return folder


def test_a_broken_file_is_named_and_stops_no_other_robot(robots):
    found = {row["robot"]: row for row in rows(robots / "alone/summary.csv")}
    assert len(found) == ROBOTS
    refused = {name: row["refused"] for name, row in found.items() if row["refused"]}
    print(refused)
    assert refused.keys() == {"robot00007", "robot00010"}
    assert "robot00007/measurements.csv:1: found no column `joint3`" in refused["robot00007"]
    assert "robot00010/robot.urdf" in refused["robot00010"]
    for name, row in found.items():
        assert (robots / "alone" / name / "calibration.json").exists() is (name not in refused)
        if name not in refused:
            # Errors of the axes of 1° and 2 mm, and noise of 0.05 mm for each component.
            assert float(row["nominal_mm"]) > 5 > 0.3 > float(row["calibrated_mm"]), row


# The common part of both engines is covered by ray for every change above; a folder by ray, which starts more slowly, is run every week.
@pytest.mark.parametrize("engine", MODULES if os.environ.get("POECAL_TRIALS") in ("weekly", "full") else ["dask"])
def test_a_folder_of_robots_has_the_same_bytes_by_several_processes(engine, robots):
    said = run("folder.py", robots / "robots", "--out", robots / engine, *by(engine))
    assert "was killed on the way" in said
    assert_same(robots / "alone", robots / engine)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["monte_carlo.py", "missing.urdf", "--out", "x"], "missing.urdf"),
        (["monte_carlo.py", "--out", "x", "--trials", "0"], "found `0`, expected a whole number from 1"),
        (["monte_carlo.py", "--out", "x", "--kill-one"], "found no process of its own to kill"),
        (["folder.py", "missing"], "missing: found no folders of robots"),
    ],
)
def test_what_cannot_be_run_is_said_in_a_sentence(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = run(*arguments, code=2)
    assert words in said and "Traceback" not in said
    assert list(tmp_path.iterdir()) == []
