"""The nominal and the calibrated robot in rerun's viewer, with the difference of their tips drawn 50 times its size.

Writes ``calibration.rrd`` (or the file named): open it with ``rerun calibration.rrd``. Needs ``pip install rerun-sdk``.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import poecal

try:
    import rerun
except ModuleNotFoundError:
    sys.exit("with_rerun.py needs rerun: pip install rerun-sdk")

ELBOW = Path(__file__).parents[1] / "elbow"
ENLARGED = 50.0


def arm(robot: poecal.Robot, joints: NDArray[np.float64]) -> NDArray[np.float64]:
    """The base, the origins of the joint frames, and the tip in one configuration, shape (n + 2, 3)."""
    return np.vstack([np.zeros(3), robot.joint_poses(joints)[:, :3, 3], robot.forward_kinematics(joints)[:3, 3]])


robot = poecal.Robot.read(ELBOW / "robot.urdf")
measured = poecal.Measurements.from_csv(ELBOW / "points.csv", robot)
calibration = poecal.calibrate(robot, measured)
path = sys.argv[1] if len(sys.argv) > 1 else "calibration.rrd"

rerun.init("poecal")
rerun.save(path)
rerun.log("robot", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
for row, joints in enumerate(measured.joints):
    rerun.set_time("row", sequence=row)
    tips = {}
    for name, model, color in [("nominal", robot, [160, 160, 160]), ("calibrated", calibration.robot, [40, 110, 220])]:
        places = arm(model, joints)
        tips[name] = places[-1]
        rerun.log(f"robot/{name}", rerun.LineStrips3D([places], colors=[color], radii=0.01))
        rerun.log(f"robot/{name}/joints", rerun.Points3D(places, colors=[color], radii=0.02))
    error = tips["calibrated"] - tips["nominal"]
    rerun.log("robot/error", rerun.Arrows3D(origins=[tips["nominal"]], vectors=[ENLARGED * error], colors=[[220, 60, 40]]))
    rerun.log("error_mm", rerun.Scalars(1e3 * float(np.linalg.norm(error))))
print(f"written     {path}: {len(measured)} configurations")
