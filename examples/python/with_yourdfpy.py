"""The calibrated URDF in yourdfpy, as tools for meshes, scenes and simulation load it.

Needs ``pip install yourdfpy``.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import poecal

try:
    import yourdfpy
except ModuleNotFoundError:
    sys.exit("with_yourdfpy.py needs yourdfpy: pip install yourdfpy")

ELBOW = Path(__file__).parents[1] / "elbow"

robot = poecal.Robot.read(ELBOW / "robot.urdf")
calibration = poecal.calibrate(robot, poecal.Measurements.from_csv(ELBOW / "points.csv", robot))
with tempfile.TemporaryDirectory() as folder:
    calibration.write(Path(folder) / "out")
    loaded = yourdfpy.URDF.load(str(Path(folder) / "out/calibrated.urdf"), load_meshes=False)

joints = np.random.default_rng(1).uniform(-1.5, 1.5, (100, 6))
worst = 0.0
for values, pose in zip(joints, calibration.predict(joints, model="calibrated"), strict=True):
    loaded.update_cfg(dict(zip(robot.joint_names, values, strict=True)))
    seen = loaded.get_transform(robot.tip_link, robot.base_link)
    worst = max(worst, float(np.linalg.norm(seen[:3, 3] - pose[:3, 3])))
print(f"calibrated  yourdfpy's tip is {1e3 * worst:.1e} mm from poecal's at most")
