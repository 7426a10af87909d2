#!/usr/bin/env bash
# The screw of a pose that is turned by more than 90 degrees, in dual_quaternions.
#
# Expected: from_homogeneous_matrix(T).screw() is the screw motion of T, and from_screw of it is T again: both
# signs of a dual quaternion are one pose.
# What happens: of poses that are turned by more than 90 degrees many, from 120 degrees on half, have the screw
# of another pose: where w of the quaternion is negative, the angle is brought to less than half a turn, which
# changes the sign of w alone, and the pose turns backwards about the same axis. pow() goes by the screw:
# T.pow(1) is not T, and is off by twice what is missing from half a turn, 100 degrees at 130. Which poses
# it meets depends on the sign that the conversion from the matrix happens to take. Up to 90 degrees all is
# exact, and so is sclerp, which looks at signs itself.
# Whom it hurts: whoever takes screws of motions for a hand-eye calibration by dual quaternions, which wants
# large turns: they are equal for camera and hand but for noise, unless one of them is backwards. Turn the
# sign of both parts around where q_r.w is negative.
# poecal: has no dual quaternions; its logarithm is of the pose.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check dual-quaternions==0.4.0 pyquaternion==0.9.9 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from dual_quaternions import DualQuaternion
from scipy.spatial.transform import Rotation

print("dual_quaternions", version("dual_quaternions"), "by pyquaternion", version("pyquaternion"))
COUNT = 200


def miss(one, other):
    """Angle between the rotations of two poses, and whether they are one pose."""
    return Rotation.from_matrix(one[:3, :3].T @ other[:3, :3]).magnitude(), np.allclose(one, other, atol=1e-9)


random = np.random.default_rng(1)
unchanged = True
print("turned by, poses whose screw is another pose's, of these with w < 0, the largest angle between them,")
print("the same by pow(1), and with w made positive:")
for degrees in (30, 60, 89, 100, 130, 150, 179):
    wrong, negative, worst, by_power, mended = 0, 0, 0.0, 0.0, 0.0
    for _ in range(COUNT):
        axis = random.normal(size=3)
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_rotvec(np.radians(degrees) * axis / np.linalg.norm(axis)).as_matrix()
        pose[:3, 3] = random.normal(size=3)
        dual = DualQuaternion.from_homogeneous_matrix(pose)
        unchanged = unchanged and np.allclose(dual.homogeneous_matrix(), pose, atol=1e-12)
        angle, same = miss(DualQuaternion.from_screw(*dual.screw()).homogeneous_matrix(), pose)
        wrong, negative = wrong + (not same), negative + (not same and dual.q_r.w < 0)
        worst, by_power = max(worst, angle), max(by_power, miss(dual.pow(1).homogeneous_matrix(), pose)[0])
        positive = DualQuaternion(-dual.q_r, -dual.q_d) if dual.q_r.w < 0 else dual
        mended = max(mended, miss(DualQuaternion.from_screw(*positive.screw()).homogeneous_matrix(), pose)[0])
    angles = [np.degrees(angle) for angle in (worst, by_power, mended)]
    print(f"{degrees:5} deg {wrong:6} of {COUNT} {negative:6} {angles[0]:10.1f} deg {angles[1]:8.1f} deg {angles[2]:8.0e} deg")
    unchanged = unchanged and mended < 1e-9 and wrong == negative
    if degrees < 90:
        unchanged = unchanged and wrong == 0
    else:
        unchanged = unchanged and wrong > 10 and abs(angles[0] - 2 * (180 - degrees)) < 1e-6 and by_power > 0.9 * worst
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
