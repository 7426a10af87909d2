#!/usr/bin/env bash
# Roll, pitch and yaw of a rotation matrix, by AHRS.
#
# Expected: DCM(rpy=...).to_rpy() gives back what it was made of, up to the order, and DCM and Quaternion of one
# rotation have the same angles.
# What happens: to_rpy, and to_angles that is the same, gives the angles of the transposed matrix, the rotation
# backwards: DCM(x=0.1).to_rpy() is -0.1. Where all three angles are not zero more than the sign differs: a
# matrix of roll 0.1, pitch 0.2, yaw 0.3 has -0.038, -0.220, -0.286. Quaternion of the same package is right both
# ways, and of the same matrix it has other angles. Besides, rpy of DCM wants yaw first, as a note of its
# documentation says, and rpy of Quaternion wants roll first. Nothing is said.
# Whom it hurts: whoever turns orientations of an inertial unit, a tracker or a robot into angles by a matrix: a
# tool that is turned by 1 degree about each axis is off by 3.5 degrees, one at 10 degrees by 34. Go through
# Quaternion(dcm=...).to_angles().
# poecal: reads and writes roll, pitch, yaw as rotations about the fixed axes x, y, z in this order, as URDF has them.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check ahrs==0.4.0 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from ahrs import DCM, Quaternion
from scipy.spatial.transform import Rotation

print("AHRS", version("ahrs"))


def apart(angles, rotation):
    """Degrees between roll, pitch, yaw about fixed axes and a rotation."""
    return np.degrees((Rotation.from_euler("xyz", np.array(angles)).inv() * rotation).magnitude())


unchanged = True
print("one axis:", ", ".join(f"DCM({axis}=0.1).to_rpy() {np.round(DCM(**{axis: 0.1}).to_rpy(), 3) + 0.0}" for axis in "xyz"))
unchanged = unchanged and np.allclose(DCM(x=0.1).to_rpy(), [-0.1, 0, 0], atol=1e-12)
made = DCM(rpy=[0.3, 0.2, 0.1])
print("DCM(rpy=[0.3, 0.2, 0.1]).to_rpy()", np.round(made.to_rpy(), 3))
unchanged = unchanged and np.allclose(made, Rotation.from_euler("ZYX", [0.3, 0.2, 0.1]).as_matrix(), atol=1e-12)
unchanged = unchanged and np.allclose(made.to_rpy(), [-0.0379, -0.2201, -0.2858], atol=1e-3)
made = Quaternion(rpy=[0.3, 0.2, 0.1])
print("Quaternion(rpy=[0.3, 0.2, 0.1]).to_angles()", np.round(made.to_angles(), 3))
unchanged = unchanged and np.allclose(made.to_angles(), [0.3, 0.2, 0.1], atol=1e-12)
print("degrees about each axis: to_rpy of the matrix is off by, the same transposed, to_angles of the quaternion")
for degrees in (1, 10, 30, 60):
    turn = Rotation.from_euler("xyz", 3 * [np.radians(degrees)])
    matrix, quaternion = DCM(turn.as_matrix()), Quaternion(turn.as_quat(scalar_first=True))
    misses = apart(matrix.to_rpy(), turn), apart(matrix.to_rpy(), turn.inv()), apart(quaternion.to_angles(), turn)
    print(f"  {degrees:3} {misses[0]:12.3f} {misses[1]:12.3f} {misses[2]:12.3f} degrees")
    unchanged = unchanged and misses[0] > 1.5 * degrees and misses[1] < 1e-6 and misses[2] < 1e-6
    unchanged = unchanged and np.array_equal(matrix.to_rpy(), matrix.to_angles())
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
