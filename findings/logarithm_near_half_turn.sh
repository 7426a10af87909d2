#!/usr/bin/env bash
# The logarithm of poses that are nearly half a turn, in spatialmath-python and modern_robotics.
#
# Expected: the logarithm gets inexact near a half turn, where the axis changes its sign, by perhaps
# 1e-8: both packages go with textbooks, and both treat the half turn itself apart.
# What happens: the closer to it, the worse. 1e-6 rad away, exp(log(T)) moves a point at a distance of
# 1 m by half a millimetre, and 1e-7 away by centimetres. At the double that is nearest to pi itself
# SE3.log is exact again, and MatrixLog6 is NaN for some poses. UnitQuaternion.angvec loses several
# times as much. Nothing is said, and scipy is exact to 1e-15 in the same poses.
# Whom it hurts: tools that point down are half a turn from their base, and what stands in files comes
# just that near: 3.14159 is 2.7e-6 away from pi, and 3.1415927 is 5e-8 away. Twists, inverse
# kinematics, interpolation and errors of such poses go through this logarithm.
# poecal: its logarithm is exact up to pi, and residuals are those of small motions.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check spatialmath-python==1.1.18 modern-robotics==1.1.1 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import modern_robotics
import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation
from spatialmath import SE3, UnitQuaternion
from spatialmath.base import trexp

print(*(f"{name} {version(name)}" for name in ("spatialmath-python", "modern-robotics", "scipy")), sep=", ")
random = np.random.default_rng(1)


def worst(away):
    """Over 50 poses this far from a half turn, the largest of what is lost by exp(log(T)), in mm of a point 1 m away."""
    lost = np.zeros(4)
    for _ in range(50):
        axis, position, point = (x / np.linalg.norm(x) for x in random.normal(size=(3, 3)))
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = Rotation.from_rotvec((np.pi - away) * axis).as_matrix(), position
        angle, about = UnitQuaternion(pose[:3, :3]).angvec()
        turned = np.eye(4)
        turned[:3, :3], turned[:3, 3] = Rotation.from_rotvec(angle * about).as_matrix(), position
        twist = RigidTransform.from_matrix(pose).as_exp_coords()
        textbook = modern_robotics.MatrixExp6(modern_robotics.MatrixLog6(pose))
        back = trexp(SE3(pose, check=False).log(twist=True)), turned, textbook, RigidTransform.from_exp_coords(twist).as_matrix()
        lost = np.maximum(lost, [1000 * np.linalg.norm(((x - pose) @ [*point, 1])[:3]) for x in back])
    return lost


print("lost, mm, this far from pi:    SE3.log   UnitQuaternion.angvec   MatrixLog6   scipy")
rows = {away: worst(away) for away in (1e-1, 1e-3, 1e-5, 1e-6, 1e-7, 0.0)}
for away, lost in rows.items():
    print(f"{away:26.0e}  {lost[0]:11.1e} {lost[1]:18.1e} {lost[2]:16.1e} {lost[3]:10.1e}")
unchanged = all(lost[3] < 1e-9 for lost in rows.values()) and max(rows[1e-1]) < 1e-8 and np.isnan(rows[0.0][2])
unchanged = unchanged and all(0.01 < rows[1e-6][k] < 100 and rows[1e-7][k] > 1 for k in range(3))
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
