#!/usr/bin/env bash
# Yaw, pitch and roll of a quaternion, by pyquaternion.
#
# Expected: yaw_pitch_roll gives "intrinsic Tait-Bryan angles following the z-y'-x'' convention" (the documentation), as
# rpy of a URDF, Fanuc and KUKA have them: Rz(yaw) Ry(pitch) Rx(roll) is the rotation again.
# What happens: the angles are those of Rx(roll) Ry(pitch) Rz(yaw), of the order x-y'-z''. The documentation says
# that product too, two lines below, and calls it z-y'-x''. One angle alone is right in either order, and 1° each
# is off by 0.03°, so that a trial does not show it; of 10° each the rotation is off by 2.6°, of 30° by 16°.
# Whom it hurts: whoever writes poses of a tool for a controller or a URDF by them: 46 mm at 1 m for a tool at 10°.
# poecal: reads both, by the name that a mapping gives the order: `intrinsic_zyx` or `intrinsic_xyz` (docs/file-formats.md).
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pyquaternion==0.9.9 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from pyquaternion import Quaternion
from scipy.spatial.transform import Rotation

print("pyquaternion", version("pyquaternion"))
x, y, z = np.eye(3)
unchanged = "z-y'-x'' convention" in Quaternion.yaw_pitch_roll.__doc__
print("degrees given; yaw, pitch, roll found; off as z-y'-x'' and as x-y'-z'', degrees")
for yaw, pitch, roll in ((10, 0, 0), (0, 10, 0), (0, 0, 10), (1, 1, 1), (10, 10, 10), (30, 30, 30), (90, 20, 0)):
    turns = [Quaternion(axis=axis, degrees=angle) for axis, angle in ((z, yaw), (y, pitch), (x, roll))]
    given = turns[0] * turns[1] * turns[2]
    found = given.yaw_pitch_roll
    truth = Rotation.from_quat(given.elements, scalar_first=True)
    off = [np.degrees((Rotation.from_euler(order, angles).inv() * truth).magnitude()) for order, angles in (("ZYX", found), ("XYZ", found[::-1]))]
    print(f"  {yaw:3} {pitch:3} {roll:3}: {' '.join(f'{np.degrees(it):7.2f}' for it in found)}; {off[0]:6.3f} and {off[1]:.3f}")
    alone = sum(it != 0 for it in (yaw, pitch, roll)) == 1
    unchanged = unchanged and off[1] < 1e-6 and (off[0] < 1e-6 if alone else off[0] > 0.02)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
