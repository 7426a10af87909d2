#!/usr/bin/env bash
# Powers of poses as dual quaternions, in DQ Robotics.
#
# Expected: log of a pose is its screw, as of any dual quaternion, and pow(x, 0.5) is half of its motion: twice that
# is x, and a pose that turns about an axis stays on its circle.
# What happens: log puts half the translation beside half the turn, without the screw that both make, and exp is the
# inverse of that, so that exp(log(x)) is x to the last bit. pow(x, 0.5) halves the turn and the translation each for
# itself; twice it is another pose: for a turn of 1 rad and 3.7 m of translation by 0.6 m, and a turn about an axis 1 m
# away goes along its chord, 122 mm inside the circle. Without turn or without translation all is right.
# Whom it hurts: whoever interpolates, averages or filters poses by powers and logarithms (ScLERP), or takes
# 2 log(x) for the twist that leads to x. The other functions, and kinematics, are not touched.
# poecal: logarithms of poses are screws; exp and log are inverse, and powers compose.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check dqrobotics==26.4.0a7 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import math
import sys
from importlib.metadata import version
import dqrobotics as dq
import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

print("DQ Robotics", version("dqrobotics"))


def pose(axis, angle, place):
    turn = dq.DQ([math.cos(angle / 2), *(math.sin(angle / 2) * np.array(axis))])
    return turn + 0.5 * dq.E_ * dq.DQ([0, *place]) * turn


def right(axis, angle, place):
    return RigidTransform.from_components(place, Rotation.from_rotvec(angle * np.array(axis)))


unchanged = True
print("turn, rad, with a translation by 1, 2, 3 m: m between exp(log(x)) and x, pow(x, 0.5) twice and x, scipy's root twice and x")
for angle in (0.0, 0.01, 0.1, 1.0, 2.0):
    x, truth = pose([0.6, 0, 0.8], angle, [1, 2, 3]), right([0.6, 0, 0.8], angle, [1, 2, 3])
    half, root = dq.pow(x, 0.5), truth**0.5
    places = [dq.translation(it).vec3() for it in (dq.exp(dq.log(x)), half * half)] + [(root * root).translation]
    off = [float(np.linalg.norm(place - np.array([1, 2, 3]))) for place in places]
    print(f"  {angle:4}  {off[0]:.1e}  {off[1]:.4f}  {off[2]:.1e}")
    unchanged = unchanged and off[0] < 1e-12 and off[2] < 1e-12 and (off[1] < 1e-12 if angle == 0 else 0.3 * angle < off[1] < 2.5 * angle)
# A turn by 1 rad about a line along z through x = 1 m.
place = np.array([1 - math.cos(1), -math.sin(1), 0])
found = dq.translation(dq.pow(pose([0, 0, 1], 1.0, place), 0.5)).vec3()
truth = (right([0, 0, 1], 1.0, place) ** 0.5).translation
print("half of a turn by 1 rad about an axis 1 m away:", np.round(found, 4), "scipy", np.round(truth, 4), f"- distance to the axis {np.hypot(found[0] - 1, found[1]):.4f} m")
unchanged = unchanged and np.allclose(found, place / 2, atol=1e-12) and np.allclose(truth, [1 - math.cos(0.5), -math.sin(0.5), 0], atol=1e-12)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
