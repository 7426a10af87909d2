#!/usr/bin/env bash
# Roll, pitch and yaw of a rotation whose pitch is 90 degrees or almost, in Klampt and SymForce.
#
# Expected: at the lock many angles say the same rotation, and one of them is returned; near it they are
# less precise, by perhaps 1e-8 rad. So it is in SciPy, pinocchio, Drake and GTSAM.
# What happens: so3.rpy of Klampt returns angles of another rotation between 1e-7 and 1e-5 rad from the lock,
# by up to 0.08 rad: an arc cosine takes the root of what the cosine of an arc sine lost. to_yaw_pitch_roll
# of SymForce does so at the lock itself, by any angle: it says that angles are not unique there, and
# forms them of two small numbers that are rounding. Quaternions of both are right.
# Whom it hurts: whoever writes a <origin> or a pose of a program by them. "1.570796", a right angle of six
# decimals, as most URDFs have it, is 3e-7 rad from the lock, and a tool that points straight down or
# ahead is often exactly there.
# poecal: writes rpy that give its rotations back to 1e-12 rad in both places.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check Klampt==0.10.1.post1 symforce-sym==0.12.0 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import math
import sys
import warnings
from importlib.metadata import version
import numpy as np
import sym
from klampt.math import so3
from scipy.spatial.transform import Rotation

warnings.simplefilter("ignore")  # SciPy's of the lock itself
print("Klampt", version("Klampt"), "and SymForce", version("symforce-sym"))


def by_klampt(turn):
    given = list(turn.as_matrix().T.ravel())  # by columns
    back = so3.from_rpy(so3.rpy(given)), so3.from_quaternion(so3.quaternion(given))
    return [Rotation.from_matrix(np.reshape(each, (3, 3)).T) for each in back]


def by_symforce(turn):
    given = sym.Rot3.from_storage(list(turn.as_quat()))
    again = sym.Rot3.from_yaw_pitch_roll(*np.ravel(given.to_yaw_pitch_roll()))
    return Rotation.from_quat(again.to_storage()), Rotation.from_quat(given.to_storage())


def by_scipy(turn):
    return Rotation.from_euler("xyz", turn.as_euler("xyz")), Rotation.from_quat(turn.as_quat())


def misses(pitch, read):
    """The largest angles between 400 rotations and what is read of them, by angles and by quaternions."""
    random = np.random.default_rng(1)
    worst = np.zeros(2)
    for roll, yaw in random.uniform(-3, 3, (400, 2)):
        turn = Rotation.from_euler("xyz", (roll, pitch, yaw))
        worst = np.maximum(worst, [(turn.inv() * other).magnitude() for other in read(turn)])
    return worst


READERS = {"Klampt": by_klampt, "SymForce": by_symforce, "SciPy": by_scipy}
unchanged = True
print("pitch                 largest miss of the angles, rad")
for name, pitch, wrong in (
    ("1.0", 1.0, ""),
    ("1.56", 1.56, ""),
    ("1.57079", 1.57079, None),
    ("1.570796", 1.570796, "Klampt"),
    ("pi/2", math.pi / 2, "SymForce"),
):
    seen = {reader: misses(pitch, read) for reader, read in READERS.items()}
    print(f"  {name:10}", "   ".join(f"{reader} {angles:7.1e}" for reader, (angles, _) in seen.items()))
    for reader, (angles, quaternions) in seen.items():
        unchanged = unchanged and quaternions < 1e-7
        if wrong is not None:
            unchanged = unchanged and (angles > 0.01 if reader == wrong else angles < 1e-6)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
