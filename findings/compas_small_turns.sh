#!/usr/bin/env bash
# Small turns of frames, as axis and angle, in COMPAS.
#
# Expected: Frame.axis_angle_vector and Rotation.axis_and_angle keep small turns, as quaternions and Euler
# angles of the same frame do.
# What happens: turns below 5 to 7 mrad, up to 0.4 degrees, are exactly zero, and turns that are as close
# to a half turn are made half turns: seven millimetres at 1 m. Nothing is said; no documentation of
# these properties names a threshold.
# Whom it hurts: whoever sends frames to a Universal Robot, whose poses are axis-angle vectors, or compares
# frames of a calibration by them: corrections of joints, tools and bases are turns of this size, and
# tools that point downwards are half turns. Frame.quaternion keeps them.
# poecal: keeps turns of any size; `poecal predict` and programs that it compensates state them in full.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check compas==2.15.1 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" - <<'PY'
import math
import sys
import compas
import numpy as np
from compas.geometry import Frame
from scipy.spatial.transform import Rotation

print("compas", compas.__version__)


def miss(turn, read):
    """Angle between a turn and what a frame with it says."""
    matrix = turn.as_matrix()
    return (turn.inv() * read(Frame([0, 0, 0], matrix[:, 0], matrix[:, 1]))).magnitude()


def by_vector(frame):
    return Rotation.from_rotvec(list(frame.axis_angle_vector))


def by_quaternion(frame):
    return Rotation.from_quat([*frame.quaternion.xyzw])


unchanged = True
print("                              axis_angle_vector off by   at 1 m      quaternion off by")
for angle in (0.05, 0.01, 0.006, 0.003, 0.001):
    for away in (0.0, math.pi):
        turn = Rotation.from_rotvec(np.array([0.6, 0.0, 0.8]) * abs(away - angle))
        vector, quaternion = miss(turn, by_vector), miss(turn, by_quaternion)
        name = f"{angle} rad" + (" from a half turn" if away else "")
        print(f"  {name:27} {vector:14.6f} rad {1000 * vector:12.3f} mm {quaternion:12.0e} rad")
        unchanged = unchanged and quaternion < 1e-7
        unchanged = unchanged and (vector < 1e-7 if angle > 0.008 else abs(vector - angle) < 0.01 * angle)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
