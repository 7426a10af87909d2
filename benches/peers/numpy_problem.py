"""What the peers in Python share: reading a problem, rotations of many rows at once, and timing."""

import json
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

TOLERANCE = 1e-10
# A fit is repeated for about so many seconds of CPU time, as `poecal calibrate --timings` does.
LONG_ENOUGH, TOO_LONG, FEWEST_REPEATS = 0.3, 2.0, 3


class Robot(NamedTuple):
    points: np.ndarray  # n × 3: a point on each axis
    frames: np.ndarray  # n × 3 × 3: columns are two directions across the axis, and the axis
    home_rotation: np.ndarray
    home_position: np.ndarray
    sigmas: np.ndarray  # standard deviation of a residual's rows


class Rows(NamedTuple):
    readings: np.ndarray  # m × n
    positions: np.ndarray  # m × 3
    rotations: np.ndarray  # m × 3 × 3; of points, m × 0


def read(folder: str, mode: str) -> tuple[Robot, Rows, Rows]:
    """The nominal robot, the measurements and the held-out rows."""
    lines = [line.split() for line in (Path(folder) / "robot.txt").read_text().splitlines()]
    named = {word: np.array(numbers, float) for word, *numbers in lines}
    screws = np.array([numbers for word, *numbers in lines if word == "joint"], float)
    linear, direction = screws[:, :3], screws[:, 3:]
    aside = np.where(np.abs(direction[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]])
    x = aside - direction * (direction * aside).sum(1, keepdims=True)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    frames = np.stack([x, np.cross(direction, x), direction], axis=2)
    sigmas = np.repeat(named["noise"], 3)[: 6 if mode == "pose" else 3]
    home = named["home"]
    robot = Robot(np.cross(direction, linear), frames, rotation_of_quaternion(home[3:]), home[:3], sigmas)
    return robot, read_rows(folder, "measurements", len(screws)), read_rows(folder, "held_out", len(screws))


def read_rows(folder: str, name: str, joints: int) -> Rows:
    table = np.loadtxt(Path(folder) / f"{name}.txt", ndmin=2)
    quaternions = table[:, joints + 3 :]
    rotations = rotation_of_quaternion(quaternions) if quaternions.size else quaternions
    return Rows(table[:, :joints], table[:, joints : joints + 3], rotations)


def rotation_of_quaternion(quaternion: np.ndarray) -> np.ndarray:
    x, y, z, w = np.moveaxis(quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def skew(a: np.ndarray) -> np.ndarray:
    """… × 3 to … × 3 × 3."""
    matrix = np.zeros((*a.shape, 3))
    matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0] = a[..., 0], a[..., 1], a[..., 2]
    return matrix - np.swapaxes(matrix, -1, -2)


def exp_and_jacobian(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotations by the vectors `a`, and J of exp(a + da) = exp(J da) exp(a)."""
    square = (a * a).sum(-1)[..., None, None]
    angle = np.sqrt(square)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    sine = np.where(small, 1 - square / 6, np.sin(safe) / safe)
    versine = np.where(small, 0.5 - square / 24, (1 - np.cos(safe)) / safe**2)
    rest = np.where(small, 1 / 6 - square / 120, (safe - np.sin(safe)) / safe**3)
    hat = skew(a)
    hat2 = hat @ hat
    return np.eye(3) + sine * hat + versine * hat2, np.eye(3) + versine * hat + rest * hat2


def log(rotation: np.ndarray) -> np.ndarray:
    """Vectors of rotations, below half a turn."""
    r = rotation
    v = 0.5 * np.stack([r[..., 2, 1] - r[..., 1, 2], r[..., 0, 2] - r[..., 2, 0], r[..., 1, 0] - r[..., 0, 1]], -1)
    sine = np.sqrt((v * v).sum(-1))
    angle = np.arctan2(sine, 0.5 * (r[..., 0, 0] + r[..., 1, 1] + r[..., 2, 2] - 1))
    return v * np.where(sine < 1e-9, 1.0, angle / np.where(sine < 1e-9, 1.0, sine))[..., None]


def rms_mm(distances_m: np.ndarray) -> float:
    return float(1e3 * np.sqrt((distances_m**2).sum(1).mean()))


def repeat(fit):
    """What `fit` gives, and the median of its CPU milliseconds."""
    times = []
    while not times or (sum(times) < TOO_LONG and (sum(times) < LONG_ENOUGH or len(times) < FEWEST_REPEATS)):
        start = time.process_time()
        result = fit()
        times.append(time.process_time() - start)
    return result, 1e3 * sorted(times)[len(times) // 2]


def report(cpu_ms: float, iterations: int, held_out_mm: float) -> None:
    print(json.dumps({"cpu_ms": cpu_ms, "iterations": iterations, "held_out_mm": held_out_mm}))
