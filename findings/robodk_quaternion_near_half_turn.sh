#!/usr/bin/env bash
# Quaternions of poses that are nearly half a turn, or hardly turned, in robodk's robomath.
#
# Expected: pose_2_quaternion, with which RAPID targets are written (Pose_2_ABB), is exact to 1e-9, as
# Pose_2_Fanuc, Pose_2_KUKA and Pose_2_Staubli of the same module are.
# What happens: from 4e-4 rad before a half turn on, the quaternion is that of a half turn, and its axis
# is not the right one: up to 7e-4 rad of error, 0.7 mm at 1 m. Turns below 4e-5 rad become none at
# all. With the angles of the other makers the same poses come through unharmed.
# Whom it hurts: whoever writes corrected targets for an ABB: a tool that points down is half a turn
# from the base, and its correction by a calibration is of just this size.
# poecal: compensates RAPID programs itself, with quaternions that have full precision.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check robodk==6.0.2 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from robodk import robomath
from scipy.spatial.transform import Rotation

print("robodk", version("robodk"))
random = np.random.default_rng(1)


def worst(angle):
    """Over 40 axes, the largest error in rad of a turn by this angle: as a quaternion, and as Fanuc's angles and back."""
    errors = np.zeros(2)
    for axis in random.normal(size=(40, 3)):
        true = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
        pose = np.eye(4)
        pose[:3, :3] = true.as_matrix()
        pose = robomath.Mat(pose.tolist())
        w, x, y, z = robomath.pose_2_quaternion(pose)
        fanuc = np.array(robomath.Fanuc_2_Pose(robomath.Pose_2_Fanuc(pose)).rows)[:3, :3]
        back = Rotation.from_quat([x, y, z, w]), Rotation.from_matrix(fanuc)
        errors = np.maximum(errors, [(true.inv() * rotation).magnitude() for rotation in back])
    return errors


print("turn, rad              worst error as a quaternion   as Fanuc's W, P, R")
rows = {}
for name, base in (("pi - ", np.pi), ("", 0.0)):
    for away in (1e-2, 1e-3, 3e-4, 1e-4, 1e-5):
        rows[name + f"{away:.0e}"] = quaternion, fanuc = worst(abs(base - away))
        print(f"{name + format(away, '.0e'):20}   {quaternion:.1e}                       {fanuc:.1e}")
unchanged = all(fanuc < 1e-14 for _, fanuc in rows.values()) and rows["pi - 1e-02"][0] < 1e-10
unchanged = unchanged and rows["pi - 3e-04"][0] > 1e-4 and rows["1e-05"][0] > 9e-6
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
