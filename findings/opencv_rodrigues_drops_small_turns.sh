#!/usr/bin/env bash
# Rotation matrices of very small turns, and of nearly half turns, in OpenCV's Rodrigues.
#
# Expected: a rotation vector is as exact as the matrix, to about 1e-15.
# What happens: a turn below 1e-5 rad becomes exactly zero. One that is x < 1e-5 rad away from a half
# turn comes out, for about half of all axes, on the other side of it, wrong by twice x: there the sign
# of the axis is not taken from the matrix. Just outside of these ranges it is exact to 1e-11, and the
# other way, vector to matrix, it is right.
# Whom it hurts: whoever takes differences of poses with it, such as corrections, drift or
# repeatability: 1e-5 rad is 10 um at 1 m, and 20 um of a camera that looks down upon the board, which
# is half a turn from the flange. An optimizer that passes through it sees steps and zero slopes.
# poecal: has its own logarithm, exact from zero to a half turn. A rotation vector in a file was
# rounded by whoever wrote it, and cannot be mended: keep the matrix or the quaternion.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check opencv-python-headless==5.0.0.93 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" - <<'PY'
import sys
import cv2
import numpy as np
import scipy
from scipy.spatial.transform import Rotation

print("OpenCV", cv2.__version__, "and scipy", scipy.__version__)
axes = np.random.default_rng(1).normal(size=(40, 3))
axes /= np.linalg.norm(axes, axis=1)[:, None]


def errors(angle):
    """The largest error in rad of a turn by this angle after matrix to vector: of OpenCV and of scipy."""
    worst = np.zeros(2)
    for axis in axes:
        true = Rotation.from_rotvec(angle * axis)
        matrix = true.as_matrix()
        both = cv2.Rodrigues(matrix)[0].ravel(), Rotation.from_matrix(matrix).as_rotvec()
        worst = np.maximum(worst, [(true.inv() * Rotation.from_rotvec(vector)).magnitude() for vector in both])
    return worst


unchanged = True
print("angle, rad            error of OpenCV   error of scipy")
for name, base, factor in (("", 0.0, 1), ("pi - ", np.pi, 2)):
    for away in (1e-7, 1e-6, 9e-6, 2e-5, 1e-3):
        opencv, other = errors(abs(base - away))
        print(f"{name + format(away, '.0e'):20}  {opencv:.1e}           {other:.1e}")
        wrong = abs(opencv - factor * away) < 0.1 * factor * away
        unchanged = unchanged and other < 1e-14 and (wrong if away < 1e-5 else opencv < 1e-10)
back = np.abs(cv2.Rodrigues(9e-6 * axes[0])[0] - Rotation.from_rotvec(9e-6 * axes[0]).as_matrix()).max()
print(f"vector of 9e-06 to matrix: error {back:.0e}")
unchanged = unchanged and back < 1e-15
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
