#!/usr/bin/env bash
# Roll, pitch and yaw of a rotation whose pitch is almost 90 degrees, in Klampt.
#
# Expected: so3.rpy is less precise near the lock, by perhaps 1e-8 rad, and from_rpy gives the rotation back.
# What happens: between 1e-7 and 1e-5 rad from the lock the three angles say another rotation, by up to
# 0.08 rad. The pitch comes from an arc sine, a cosine of it divides, and an arc cosine takes the root of
# what that lost. so3.quaternion and so3.rotation_vector of the same rotation are right.
# Whom it hurts: whoever writes a <origin> or a pose of a program by it. "1.570796", a right angle of six
# decimals, as most URDFs have it, is 3e-7 rad from the lock: the angles that come back are wrong by 0.06
# rad, which is 60 mm at 1 m.
# poecal: writes rpy that give its rotations to 1e-12 rad there too; so does scipy.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check Klampt==0.10.1.post1 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import math
import sys
import warnings
from importlib.metadata import version
import numpy as np
from klampt.math import so3
from scipy.spatial.transform import Rotation

warnings.simplefilter("ignore")  # SciPy's of the lock itself
print("Klampt", version("Klampt"))


def klampts(matrix):
    return list(matrix.T.ravel())  # a list by columns


def misses(pitch):
    """The largest angles between 400 rotations and what is read of them, by Klampt and by SciPy."""
    random = np.random.default_rng(1)
    worst = np.zeros(3)
    for roll, yaw in random.uniform(-3, 3, (400, 2)):
        turn = Rotation.from_euler("xyz", (roll, pitch, yaw))
        given = klampts(turn.as_matrix())
        angles = so3.from_rpy(so3.rpy(given))
        quaternion = so3.from_quaternion(so3.quaternion(given))
        others = [Rotation.from_matrix(np.reshape(each, (3, 3)).T) for each in (angles, quaternion)]
        others.append(Rotation.from_euler("xyz", turn.as_euler("xyz")))
        worst = np.maximum(worst, [(turn.inv() * other).magnitude() for other in others])
    return worst


unchanged = True
print("pitch                    so3.rpy off by    so3.quaternion   SciPy's angles, rad")
for name, pitch, wrong in (
    ("1.0", 1.0, False),
    ("1.56", 1.56, False),
    ("pi/2 - 1e-5", math.pi / 2 - 1e-5, None),
    ("1.57079", 1.57079, None),
    ("1.570796", 1.570796, True),
    ("1.5707963", 1.5707963, None),
    ("1.570796326794897", 1.570796326794897, False),
):
    angles, quaternion, others = misses(pitch)
    print(f"  {name:20} {angles:14.1e} {quaternion:17.1e} {others:15.1e}")
    unchanged = unchanged and quaternion < 1e-7 and others < 1e-7
    if wrong is not None:
        unchanged = unchanged and (angles > 0.01 if wrong else angles < 1e-6)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
