"""A folder of robots, each with its model and measurements: every one calibrated, with its own results, and a summary of all.

    python folder.py robots --make 1000                      # a folder to try it with: simulated robots
    python folder.py robots --engine dask --out calibrated

Each robot is a folder with `robot.urdf` and `measurements.csv`. The results of each are what `poecal calibrate` writes, without the report,
in a folder of the same name; `summary.csv` has a row for each robot. If one cannot be calibrated, its row says why, and the others go on.
Results of an earlier run are written over, each robot's as a whole: a process may end at any time.
"""

import argparse
import functools
import sys
import warnings
from pathlib import Path

import engines
import poecal

ELBOW = Path(__file__).parents[1] / "elbow/robot.urdf"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robots", type=Path, help="the folder")
    parser.add_argument("--make", type=engines.count, metavar="COUNT", help="write so many simulated robots into the folder, and end")
    parser.add_argument("--corrections", choices=["auto", "off"], default="auto", help="fit what joints do beyond geometry (default), or not")
    parser.add_argument("--out", type=Path, default=Path("calibrated"), help="folder for the results (default: calibrated)")
    engines.add_options(parser)
    options = engines.options_of(parser)
    if options.make:
        make(options.robots, options.make)
        return
    robots = sorted(path.name for path in options.robots.iterdir() if path.is_dir()) if options.robots.is_dir() else []
    if not robots:
        parser.error(f"{options.robots}: found no folders of robots, expected one for each")
    options.out.mkdir(parents=True, exist_ok=True)
    work = functools.partial(calibrated, str(options.robots), str(options.out), options.corrections)
    rows = engines.run(work, robots, options)
    engines.write(options.out / "summary.csv", rows)
    refused = [row for row in rows if row["refused"]]
    for row in refused:
        print(f"{row['robot']}: {row['refused']}", file=sys.stderr)
    levels = [row["verdict"] for row in rows]
    words = ", ".join(f"{levels.count(level):,} {level or 'refused'}" for level in sorted(set(levels), reverse=True))
    print(f"{len(rows):,} robots: {words}")


def calibrated(robots: str, out: str, corrections: str, name: str) -> engines.Row:
    """Calibrates a robot and writes its results; gives its row."""
    warnings.simplefilter("ignore", poecal.PoecalWarning)
    row: engines.Row = {"robot": name, "verdict": "", "rows": "", "nominal_mm": "", "calibrated_mm": "", "corrected_mm": "", "refused": ""}
    try:
        robot = poecal.Robot.read(Path(robots, name, "robot.urdf"))
        measured = poecal.Measurements.from_csv(Path(robots, name, "measurements.csv"), robot)
        calibration = poecal.calibrate(robot, measured, corrections=corrections)
        calibration.write(Path(out, name), force=True, report=False)
    except poecal.Error as error:
        return row | {"refused": str(error)}
    held_out = calibration.accuracy.held_out or calibration.accuracy.training
    models = {"nominal_mm": held_out.nominal, "calibrated_mm": held_out.calibrated, "corrected_mm": held_out.corrected}
    errors = {what: model.position_mm.rms for what, model in models.items() if model is not None}
    return row | {"verdict": calibration.verdict.level, "rows": len(measured)} | errors


def make(folder: Path, count: int) -> None:
    """Simulated robots of one model, each with errors and points of its own."""
    robot = poecal.Robot.read(ELBOW)
    header = ",".join([f"{name}[rad]" for name in robot.reading_names] + ["x[m]", "y[m]", "z[m]"])
    for number in range(1, count + 1):
        made = poecal.simulate(robot, kind="point", count=60, seed=number).measurements
        place = folder / f"robot{number:05}"
        place.mkdir(parents=True, exist_ok=True)
        lines = [",".join(map(repr, [*joints, *position])) for joints, position in zip(made.joints.tolist(), made.positions.tolist(), strict=True)]
        (place / "measurements.csv").write_text("\n".join([header, *lines, ""]), encoding="utf-8")
        (place / "robot.urdf").write_bytes(ELBOW.read_bytes())


if __name__ == "__main__":
    main()
