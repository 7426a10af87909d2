"""The problems: sessions that `poecal simulate` makes, and the same as plain numbers for the peers."""

import csv
import json
import math
import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ELBOW = ROOT / "examples/elbow/robot.urdf"
SNAKE_ARM = Path(__file__).resolve().parent / "snake_arm.toml"

SIGMA_POSITION = "0.05mm"
SIGMA_ROTATION = "0.0005rad"
NOISE_SI = (5e-5, 5e-4)
ERRORS = "1deg,2mm"
HELD_OUT_COUNT = 1000

SI_OF_UNIT = {"deg": math.pi / 180, "rad": 1.0, "mm": 1e-3, "m": 1.0}


@dataclass(frozen=True)
class Problem:
    """A robot, the number `m` of measurements, and the mode: `pose`, `point`, or `monte_carlo` for `fits` fits of poses."""

    model: Path
    n: int
    m: int
    mode: str
    fits: int = 0

    @property
    def name(self) -> str:
        return f"n{self.n}_m{self.m}_{self.mode}"

    @property
    def kind(self) -> str:
        return "point" if self.mode == "point" else "pose"


def make(problem: Problem, poecal: Path, folder: Path) -> Path:
    """Makes the files of a problem in a folder of their own.

    `poecal simulate` writes `measurements.csv` and `held_out.csv`; beside them are written what all peers but poecal read:
    `robot.txt`, `measurements.txt`, `held_out.txt` and, for Monte Carlo, `exact.csv` and `exact.txt`, the measurements without
    noise.
    """
    folder.mkdir(parents=True, exist_ok=True)
    made = folder / problem.name
    simulate(problem, poecal, made, f"{SIGMA_POSITION},{SIGMA_ROTATION}")
    (made / "robot.txt").write_text(robot_text(json.loads((made / "truth.json").read_text())))
    for name in ("measurements", "held_out"):
        write_numbers(made / f"{name}.csv", made / f"{name}.txt")
    if problem.mode == "monte_carlo":
        exact = folder / f"{problem.name}_exact"
        simulate(problem, poecal, exact, "0mm,0rad")
        (made / "exact.csv").write_bytes((exact / "measurements.csv").read_bytes())
        write_numbers(made / "exact.csv", made / "exact.txt")
    return made


def simulate(problem: Problem, poecal: Path, out: Path, noise: str) -> None:
    command = [poecal, "simulate", problem.model, "--kind", problem.kind, "--count", problem.m, "--device-frame", "base"]
    command += ["--errors", ERRORS, "--noise", noise, "--held-out-count", HELD_OUT_COUNT, "--out", out, "--quiet"]
    subprocess.run([str(word) for word in command], check=True)


def robot_text(truth: dict) -> str:
    """The nominal robot and the noise, a line each: `joint v w`, `home position quaternion`, `noise position rotation`."""
    lines = []
    for joint in truth["joints"]:
        screw = joint["nominal_screw"]
        lines.append(("joint", *screw["v_m"], *screw["w"]))
    home = truth["robot"]["nominal_base_from_tip_at_zero"]
    lines.append(("home", *home["position_m"], *home["quaternion_xyzw"]))
    lines.append(("noise", *NOISE_SI))
    return "".join(" ".join(map(str, line)) + "\n" for line in lines)


def write_numbers(table: Path, out: Path) -> None:
    """Writes a CSV file of measurements without its heads, in metres and radians."""
    with table.open(newline="") as source, out.open("w") as sink:
        rows = csv.reader(line for line in source if not line.startswith("#"))
        scales = [SI_OF_UNIT[head.split("[")[1].rstrip("]")] if "[" in head else 1.0 for head in next(rows)]
        for row in rows:
            sink.write(" ".join(repr(float(cell) * scale) for cell, scale in zip(row, scales)) + "\n")
