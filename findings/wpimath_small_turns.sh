#!/usr/bin/env bash
# Poses that are hardly turned, in WPILib's wpimath.
#
# Expected: Pose3d.log and exp have the precision of doubles at all turns, as Rotation3d of a rotation vector has,
# and Rotation3d(before, after) turns the one vector into the other.
# What happens: below 1e-7 rad and from 1e-5 rad on it is so. Between, log takes a difference of nearly equal
# numbers: at 1.1e-7 rad the translation is off by up to 9 mm for a pose 1 m away, at 1e-6 rad by 0.09 mm, and exp
# of it is another pose. Rotation3d of two vectors that are 4e-5 rad apart or less is no turn at all, so that the
# second one is missed by as much, 0.04 mm at 1 m; at 5e-5 rad it is exact. Nothing is said.
# Whom it hurts: whoever compares poses by their twists, or steps from one to the other: two poses along a rail or a
# straight line are turned by just that much, by rounding or by a fit.
# poecal: takes logarithms of turns of any size to the last digits of double precision.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check robotpy-wpimath==2026.2.2 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from wpimath.geometry import Pose3d, Rotation3d, Translation3d

print("robotpy-wpimath", version("robotpy-wpimath"))
random = np.random.default_rng(1)


def unit():
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


unchanged = True
print("turn, rad    log off by, mm at 1 m    exp(log) off by    second of two vectors missed by")
for turn in (1e-9, 9e-8, 1.1e-7, 1e-6, 1e-5, 4e-5, 5e-5, 1e-4, 1e-3):
    logs, backs, misses = [], [], []
    for _ in range(300):
        axis, place = unit(), unit()
        pose = Pose3d(Translation3d(*place), Rotation3d(turn * axis))
        twist = Pose3d().log(pose)
        w = turn * axis
        exact = place - np.cross(w, place) / 2 + np.cross(w, np.cross(w, place)) / 12
        logs.append(np.linalg.norm(np.array([twist.dx, twist.dy, twist.dz]) - exact))
        back = Pose3d().exp(twist)
        backs.append(np.linalg.norm(np.array([back.X(), back.Y(), back.Z()]) - place))
        first, side = unit(), np.cross(place, axis)
        side = np.cross(first, side)
        side /= np.linalg.norm(side)
        second = np.cos(turn) * first + np.sin(turn) * side
        misses.append(np.linalg.norm(np.array(Rotation3d(first, second).toMatrix()) @ first - second))
    log, back, miss = (1000 * max(each) for each in (logs, backs, misses))
    print(f"{turn:8.2g} {log:20.2g} {back:20.2g} {miss:20.2g}")
    if turn == 1.1e-7:
        unchanged = unchanged and 5 < log < 15 and 5 < back < 15
    elif turn == 1e-6:
        unchanged = unchanged and 0.05 < log < 0.2
    elif turn < 1e-7 or turn > 5e-5:
        unchanged = unchanged and log < 1e-4
    unchanged = unchanged and (abs(miss - 1000 * turn) < 1e-6 if turn <= 4e-5 else miss < 1e-9)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
