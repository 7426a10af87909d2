#!/usr/bin/env bash
# The rotation matrix of a quaternion, by pycalib.
#
# Expected: calib.quat2mat(q) is the matrix that turns points as q does, for q with w first or with w last.
# What happens: q has w last, and the matrix is the transpose: it turns the other way. With w first it is a third
# rotation. Half turns and no turn come out right, so that a tool that points straight down shows nothing.
# The documentation of the function says "quaternion to rotation matrix conversion".
# Whom it hurts: whoever takes poses of a robot, of ROS or of a tracker as quaternions into it: an arm that is
# turned by 30 degrees is off by 60. Take the transpose, or SciPy.
# poecal: reads quaternions by the names of their columns, as turning points of the target into the frame of the device.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pycalib-simple==2026.7.22.1 PyYAML==6.0.4 pandas==3.1.1 tqdm==4.70.1 \
  opencv-contrib-python==5.1.0.95 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from pycalib.calib import quat2mat
from scipy.spatial.transform import Rotation

print("pycalib-simple", version("pycalib-simple"))
AXIS = np.array([0.6, 0.0, 0.8])


def off(turn, matrix):
    return np.degrees((turn.inv() * Rotation.from_matrix(matrix)).magnitude())


unchanged = True
print("turn       quat2mat off by, w last   transposed   w first")
for degrees in (0, 30, 90, 150, 180):
    turn = Rotation.from_rotvec(np.radians(degrees) * AXIS)
    last, first = np.array(quat2mat(turn.as_quat())), np.array(quat2mat(turn.as_quat(scalar_first=True)))
    misses = off(turn, last), off(turn, last.T), off(turn, first)
    print(f"{degrees:4} deg {misses[0]:19.4f} deg {misses[1]:11.4f} deg {misses[2]:11.4f} deg")
    unchanged = unchanged and abs(misses[0] - min(2 * degrees, 360 - 2 * degrees)) < 1e-4 and misses[1] < 1e-4
    unchanged = unchanged and (degrees == 0 or misses[2] > 1)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
