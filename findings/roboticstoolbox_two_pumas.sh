#!/usr/bin/env bash
# The Puma 560 by DH parameters and by URDF, both in roboticstoolbox-python.
#
# Expected: models.DH.Puma560() and models.Puma560() are one arm, up to where its base, its tool and the zeros of its
# joints are, as the two models of the Panda are in the same package.
# What happens: two lengths of the arm differ, which no base, tool or zero makes up for. The axis of the fourth joint is
# 20.3 mm from that of the third by DH and meets it by URDF, and the wrist stands 150.05 mm beside the first axis by
# DH and 129.54 mm by URDF. Nothing is said.
# Whom it hurts: whoever tries a calibration on it, with poses of one model and the other as the nominal one, or
# compares an inverse kinematics: differences of 20 mm are a hundred times what is to be found on a real arm.
# poecal: takes the model that it is given; `poecal check` prints through which points its axes go.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check roboticstoolbox-python==1.5.0 spatialmath-python==1.1.18 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
import roboticstoolbox

print("roboticstoolbox-python", version("roboticstoolbox-python"))


def axes(poses, count):
    """Directions of the joints' axes and points on them in the base, at zero."""
    found = []
    for joint in range(count):
        there, back = (np.array(poses(sign * 0.5 * np.eye(count)[joint])) for sign in (1, -1))
        motion = there @ np.linalg.inv(back)
        turned, moved = motion[:3, :3], motion[:3, 3]
        axis = np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]])
        found.append((axis / np.linalg.norm(axis), np.linalg.lstsq(np.eye(3) - turned, moved, rcond=1e-6)[0]))
    return found


def lengths(poses, count):
    """Distances of axes that follow each other, mm: the a of DH parameters."""
    found = []
    all_axes = axes(poses, count)
    for (one, at), (two, to) in zip(all_axes, all_axes[1:]):
        across = np.cross(one, two)
        apart = to - at
        parallel = np.linalg.norm(across) < 1e-6
        found.append(1000 * (np.linalg.norm(apart - (apart @ one) * one) if parallel else abs(apart @ across) / np.linalg.norm(across)))
    return np.array(found)


def shoulder(poses, count):
    """How far the axis of the fourth joint is from the first one's along the second one's, mm."""
    (_, first), (second, _), _, (_, fourth) = axes(poses, count)[:4]
    return 1000 * abs((fourth - first) @ second)


unchanged = True
models = roboticstoolbox.models
for name, count, table, urdf in (
    ("Panda", 7, models.DH.Panda(), models.Panda()),
    ("Puma 560", 6, models.DH.Puma560(), models.Puma560()),
):
    end = "panda_link8" if name == "Panda" else None
    by_table = lambda values: table.fkine(values).A
    by_urdf = lambda values: urdf.fkine(values, end=end).A
    found = lengths(by_table, count), lengths(by_urdf, count)
    print(name)
    for kind, numbers in zip(("DH", "URDF"), found):
        print(f"  by {kind:5} axes apart by", "  ".join(f"{number:8.3f}" for number in numbers + 0.0), "mm")
    if name == "Panda":
        unchanged = unchanged and np.allclose(*found, atol=1e-3)
    else:
        offsets = shoulder(by_table, count), shoulder(by_urdf, count)
        print(f"  wrist beside the first axis: {offsets[0]:.3f} mm by DH, {offsets[1]:.3f} mm by URDF")
        unchanged = unchanged and abs(found[0][2] - 20.3) < 0.01 and found[1][2] < 0.01
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
