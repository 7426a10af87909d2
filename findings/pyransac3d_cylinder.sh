#!/usr/bin/env bash
# The axis of a cylinder that was measured finely, by pyransac3d.
#
# Expected: a consensus fit ends with a fit to all inliers, as in PCL and Open3D, or is at least as good as
# a few points of the measurement allow: for 500 points of a cylinder of 100 mm by 400 mm with 20 um of noise
# some hundredths of a degree.
# What happens: shapes are those of the last few points that were drawn, and inliers have no say. A plane is
# tilted five times as much as the fit to its inliers. A cylinder goes through three points that were drawn,
# with its axis at right angles to them: three points at random are rarely on one circle around it, so that
# after 10 000 draws the axis is off by degrees, and of 500 points 10 to 100 are inliers. The radius looks
# right. The documentation speaks of the best parameters, and nothing is said about a second step.
# Whom it hurts: whoever finds a shaft, a flange or the rotation axis of a joint by it. Fit to the inliers
# afterwards; for a cylinder there are too few.
# poecal: axes of joints are unknowns of the fit of all rows; planes that are touched, too.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pyransac3d==0.7.0 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import random
import sys
from importlib.metadata import version
import numpy as np
import pyransac3d

print("pyransac3d", version("pyransac3d"))
NOISE, COUNT = 2e-5, 500
numbers = np.random.default_rng(1)
random.seed(1)
np.random.seed(1)


def angle(one, other):
    """Between two lines, in degrees."""
    return np.degrees(np.arcsin(min(1.0, np.linalg.norm(np.cross(one, other)) / np.linalg.norm(one) / np.linalg.norm(other))))


unchanged = True
z = np.array([0.0, 0.0, 1.0])
tilts = []
for _ in range(20):
    points = np.c_[numbers.uniform(-0.5, 0.5, (COUNT, 2)), numbers.normal(0, NOISE, COUNT)]
    equation, inliers = pyransac3d.Plane().fit(points, thresh=3 * NOISE, maxIteration=300)
    kept = points[inliers] - points[inliers].mean(0)
    tilts.append((angle(equation[:3], z), angle(np.linalg.svd(kept)[2][2], z)))
tilts = np.mean(tilts, axis=0)
print(f"20 planes of 1 m by 1 m: tilted by {tilts[0]:.5f} deg on average, fits to their inliers by {tilts[1]:.5f} deg")
unchanged = unchanged and tilts[0] > 2 * tilts[1]
angles = []
print("cylinder of 100 mm by 400 mm:")
for _ in range(3):
    turn = numbers.uniform(0, 2 * np.pi, COUNT)
    points = np.c_[0.05 * np.cos(turn), 0.05 * np.sin(turn), numbers.uniform(-0.2, 0.2, COUNT)] + numbers.normal(0, NOISE, (COUNT, 3))
    center, axis, radius, inliers = pyransac3d.Cylinder().fit(points, thresh=3 * NOISE, maxIteration=10000)
    angles.append(angle(axis, z))
    print(f"  {len(inliers)} inliers of {COUNT}, axis off by {angles[-1]:.3f} deg, radius {1000 * radius:.3f} mm")
    unchanged = unchanged and len(inliers) < COUNT / 4 and abs(radius - 0.05) < 5e-4
unchanged = unchanged and np.median(angles) > 0.5
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
