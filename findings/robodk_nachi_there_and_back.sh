#!/usr/bin/env bash
# A pose as a target of a Nachi controller and back, by robodk.
#
# Expected: Nachi_2_Pose is the inverse of Pose_2_Nachi, as those of eight other makers are.
# What happens: Pose_2_Nachi lists the turn about z first and that about x last, and Nachi_2_Pose takes the first for the
# turn about x: what one writes the other reads as another pose, 33° off for 10, 20 and 30°, and by up to half a turn.
# Nothing is said. A turn about y alone, or equal turns about x and z, come back right.
# Whom it hurts: whoever reads targets of a Nachi program to compare them with poses that robodk wrote, or corrects a
# program by reading its targets, moving them, and writing them again.
# poecal: has no form for Nachi's targets; a table of them is read by a mapping that names the order of the angles
# (`orientation=intrinsic_zyx`, docs/file-formats.md).
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check robodk==6.0.2 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from robodk import robomath

print("robodk", version("robodk"))
x, y, z = robomath.rotx, robomath.roty, robomath.rotz
rad = np.radians


def numbers(pose):
    return np.array([[pose[row, column] for column in range(4)] for row in range(4)])


def off(one, other):
    turn = numbers(one)[:3, :3].T @ numbers(other)[:3, :3]
    return np.degrees(2 * np.arcsin(min(1, np.linalg.norm(turn - np.eye(3)) / 8**0.5)))


random = np.random.default_rng(1)
poses = [robomath.transl(100, 200, 300) * z(c) * y(b) * x(a) for a, b, c in random.uniform(-1.4, 1.4, (200, 3))]
print("most degrees between 200 poses and the same poses there and back")
most = {}
for maker in ("Adept", "Comau", "Fanuc", "KUKA", "Motoman", "Nachi", "Staubli", "Techman", "UR"):
    there, back = (getattr(robomath, name) for name in (f"Pose_2_{maker}", f"{maker}_2_Pose"))
    most[maker] = max(off(back(there(pose)), pose) for pose in poses)
print("  " + ", ".join(f"{maker} {angle:.3f}" for maker, angle in most.items()))
unchanged = all(angle > 90 if maker == "Nachi" else angle < 1e-5 for maker, angle in most.items())
print("angles about x, y, z, Nachi's target of them, and what is read, degrees off")
for angles in ((10, 20, 30), (10, 0, 0), (0, 20, 0), (10, 20, 10)):
    pose = z(rad(angles[2])) * y(rad(angles[1])) * x(rad(angles[0]))
    target = robomath.Pose_2_Nachi(pose)
    found = off(robomath.Nachi_2_Pose(target), pose)
    print(f"  {angles}: {[round(float(it), 3) for it in target[3:]]} {found:.3f}")
    unchanged = unchanged and np.allclose(target[3:], angles[::-1]) and (found < 1e-5 if angles[0] == angles[2] else found > 10)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
