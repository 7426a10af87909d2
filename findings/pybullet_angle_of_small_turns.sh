#!/usr/bin/env bash
# Angles of small turns, and of poses near gimbal lock, in PyBullet.
#
# Expected: PyBullet's quaternions have double precision outside the simulator, and its helpers are good to it; or to
# single precision, 1e-7.
# What happens: getAxisAngleFromQuaternion takes the arc cosine of w in single precision, which is 1 for all turns below
# 3.4e-4 rad: they have the angle 0, 5e-4 rad are 38 % too many and 1e-3 rad 2 % too few. The quaternion itself has
# the turn to seven digits. getEulerFromQuaternion is exact up to a pitch of 89.7 degrees, and what is beyond it
# calls gimbal lock: roll becomes zero, and the three angles are of a rotation that is up to 4.6 mrad away.
# Whom it hurts: whoever measures the error of a pose by getDifferenceQuaternion and its angle, as many inverse
# kinematics and tests of PyBullet do: orientation errors below 0.02 degrees are none. Take 2 asin of the length of
# the vector part.
# poecal: logarithms of rotations are by the vector part near zero, and by both near a half turn.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pybullet==3.2.7 numpy==2.4.6
"$here/venv/bin/python" -W ignore - <<'PY'
import math
import sys
from importlib.metadata import version
import pybullet

print("PyBullet", version("pybullet"))
unchanged = True
print("turn about x, rad: angle of its quaternion, 2 asin of the vector part of the difference from none")
for turn in (1e-5, 1e-4, 3e-4, 5e-4, 1e-3, 1e-2):
    quaternion = [math.sin(turn / 2), 0, 0, math.cos(turn / 2)]
    angle = pybullet.getAxisAngleFromQuaternion(quaternion)[1]
    vector = 2 * math.asin(pybullet.getDifferenceQuaternion([0, 0, 0, 1], quaternion)[0])
    print(f"  {turn:.0e}  {angle:.7f}  {vector:.7f}")
    unchanged = unchanged and abs(vector / turn - 1) < 1e-6
    unchanged = unchanged and {3e-4: angle == 0, 5e-4: angle > 6.5e-4, 1e-3: angle < 9.8e-4}.get(turn, True)
print("pitch, rad, with roll 0.3 and yaw 0.7: roll, pitch and yaw found, and the angle to the rotation, rad")
for pitch, near in ((1.5, 0.0), (1.566, 0.0), (1.5664, 4.6e-3), (1.57, 8.3e-4), (1.5706, 2.05e-4)):
    quaternion = pybullet.getQuaternionFromEuler([0.3, pitch, 0.7])
    found = pybullet.getEulerFromQuaternion(quaternion)
    again = pybullet.getQuaternionFromEuler(found)
    x, y, z, w = quaternion
    a, b, c, d = again
    apart = 2 * math.asin(min(1.0, math.hypot(w * a - x * d - y * c + z * b, w * b + x * c - y * d - z * a, w * c - x * b + y * a - z * d)))
    print(f"  {pitch}  {found[0]:.5f} {found[1]:.7f} {found[2]:.5f}  {apart:.2e}")
    unchanged = unchanged and (abs(apart / near - 1) < 0.1 and found[0] == 0 if near else apart < 1e-9)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
