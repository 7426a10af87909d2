"""Cost of one calibration of many for a process: ``RAYON_NUM_THREADS=1 python crates/poecal-py/benches/many.py``.

CPU time of the calls that a loop over robots makes, the least and the median of 100 calls each, and the most memory that the process has taken. Each
call is of another simulated session, so that nothing is in the caches of the last one. For files the time includes the system's, to which the disk
adds.
"""

import resource
import tempfile
import time
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any, Literal

import numpy as np

import poecal

CALLS = 100
ELBOW = Path(__file__).parents[3] / "examples/elbow/robot.urdf"


def main() -> None:
    warnings.simplefilter("ignore", poecal.PoecalWarning)
    robot = poecal.Robot.read(ELBOW)
    print(f"{'':<44}{'least':>10}{'median':>10}  ms")
    few = measured(robot, "point", 60)
    for what, sessions in [
        ("60 points", few),
        ("60 poses", measured(robot, "pose", 60)),
        ("500 points", measured(robot, "point", 500)),
        ("500 poses", measured(robot, "pose", 500)),
    ]:
        for corrections in ["auto", "off"]:
            tell(f"{what}, corrections={corrections}", partial(poecal.calibrate, robot, corrections=corrections), sessions)
    with tempfile.TemporaryDirectory() as name:
        files(robot, few, Path(name))
    print(f"most memory: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


def measured(robot: poecal.Robot, kind: Literal["point", "pose"], count: int) -> list[poecal.Measurements]:
    """A session for each call."""
    return [poecal.simulate(robot, kind=kind, count=count, seed=seed).measurements for seed in range(1, CALLS + 1)]


def files(robot: poecal.Robot, sessions: list[poecal.Measurements], folder: Path) -> None:
    """Additional time of files for a robot."""
    header = ",".join([*robot.reading_names, "x[m]", "y[m]", "z[m]"])
    paths = [folder / f"{number}.csv" for number in range(CALLS)]
    for path, session in zip(paths, sessions, strict=True):
        np.savetxt(path, np.hstack([session.joints, session.positions]), delimiter=",", header=header, comments="")
    found = [(poecal.calibrate(robot, session, corrections="off"), path) for path, session in zip(paths, sessions, strict=True)]
    tell("reading the model", poecal.Robot.read, [ELBOW] * CALLS)
    tell("reading 60 points", lambda path: poecal.Measurements.from_csv(path, robot), paths)
    tell("writing results without the report", lambda it: it[0].write(it[1].with_suffix(""), report=False), found)
    tell("writing the report too", lambda it: it[0].report(it[1].with_suffix(".html")), found)


def tell(what: str, call: Callable[[Any], Any], inputs: Sequence[Any]) -> None:
    """Times the call once for each input."""
    took = []
    for one in inputs:
        start = time.process_time()
        call(one)
        took.append(1e3 * (time.process_time() - start))
    print(f"{what:<44}{min(took):10.2f}{median(took):10.2f}")


if __name__ == "__main__":
    main()
