"""The calibrated robot in MuJoCo, by the model that poecal exports.

A calibration has no masses: 1 kg a link stands in, so this is for kinematics, rendering and contacts, not for forces.
Needs ``pip install mujoco``.
"""

import sys
import warnings
from pathlib import Path

import numpy as np

import poecal

try:
    import mujoco
except ModuleNotFoundError:
    sys.exit("with_mujoco.py needs MuJoCo: pip install mujoco")

ELBOW = Path(__file__).parents[1] / "elbow"

robot = poecal.Robot.read(ELBOW / "robot.urdf")
calibration = poecal.calibrate(robot, poecal.Measurements.from_csv(ELBOW / "points.csv", robot))
with warnings.catch_warnings():
    warnings.simplefilter("ignore", poecal.PoecalWarning)  # of the masses
    model = mujoco.MjModel.from_xml_string(calibration.export("mjcf"))
data = mujoco.MjData(model)
print(f"{model.njnt} joints from {model.body(1).name} to the site {model.site(0).name}")

lower, upper = robot.limits.T
joints = np.random.default_rng(1).uniform(lower, upper, (1000, len(lower)))
predicted = calibration.predict(joints, model="calibrated")
order = [model.joint(name).qposadr[0] for name in robot.joint_names]
distances = np.empty(len(joints))
for row, values in enumerate(joints):
    data.qpos[order] = values
    mujoco.mj_kinematics(model, data)
    distances[row] = np.linalg.norm(data.site(0).xpos - predicted[row, :3, 3])
print(f"MuJoCo's tip is {1e3 * distances.max():.1e} mm from poecal's calibrated one at most")
