"""The calibrated URDF in Pinocchio: the same model in a controller, a planner or a simulator.

poecal writes a URDF in which only the corrected numbers differ from the one delivered, so whatever read that one reads this one.
Needs ``pip install pin``.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import poecal

try:
    import pinocchio
except ModuleNotFoundError:
    sys.exit("with_pinocchio.py needs Pinocchio: pip install pin")

ELBOW = Path(__file__).parents[1] / "elbow"

robot = poecal.Robot.read(ELBOW / "robot.urdf")
calibration = poecal.calibrate(robot, poecal.Measurements.from_csv(ELBOW / "points.csv", robot))
with tempfile.TemporaryDirectory() as folder:
    calibration.write(Path(folder) / "out")
    models = {
        "nominal": pinocchio.buildModelFromUrdf(str(ELBOW / "robot.urdf")),
        "calibrated": pinocchio.buildModelFromUrdf(str(Path(folder) / "out/calibrated.urdf")),
    }

lower, upper = robot.limits.T
joints = np.random.default_rng(1).uniform(lower, upper, (1000, len(lower)))
predicted = calibration.predict(joints, model="calibrated")
for name, model in models.items():
    data = model.createData()
    base, tip = model.getFrameId(robot.base_link), model.getFrameId(robot.tip_link)
    order = [model.joints[model.getJointId(joint)].idx_q for joint in robot.joint_names]
    distances = np.empty(len(joints))
    for row, values in enumerate(joints):
        q = pinocchio.neutral(model)
        q[order] = values
        pinocchio.framesForwardKinematics(model, data, q)
        distances[row] = np.linalg.norm(data.oMf[base].actInv(data.oMf[tip]).translation - predicted[row, :3, 3])
    print(f"{name:<11} Pinocchio's tip is {1e3 * distances.max():.1e} mm from poecal's calibrated one at most")
