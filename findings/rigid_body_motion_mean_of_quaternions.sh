#!/usr/bin/env bash
# The mean of orientations of one pose, by rigid-body-motion.
#
# Expected: qmean is the mean rotation of Markley and others, the eigenvector of the largest eigenvalue, as its source
# says: of quaternions that scatter by a milliradian it is within a milliradian of them, whatever their signs.
# What happens: eigenvalues are sorted, and then the order is applied to the elements of the first eigenvector instead
# of to the eigenvectors. Where the first one is that of the largest eigenvalue, and the others are in falling order,
# the result is right; else it is that vector's elements in another order, or another vector. Two of three means
# are off by degrees, up to half a turn; the vector has length one. Nothing is said.
# Whom it hurts: whoever averages readings of a tracker or a camera at rest, or hand-eye results: the mean is another
# orientation. Take the mean of SciPy's Rotation.
# poecal: means of rotations are that eigenvector, so that signs do not matter.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check rigid-body-motion==0.9.3 numpy-quaternion==2024.0.13 numpy==2.4.6 scipy==1.17.1
HOME=$here "$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from rigid_body_motion import qmean
from scipy.spatial.transform import Rotation

print("rigid-body-motion", version("rigid-body-motion"))
numbers = np.random.default_rng(1)
COUNT, SCATTER = 1000, 1e-3


def angle(one, other):
    return np.degrees((one.inv() * other).magnitude())


ours, theirs, lengths = [], [], []
for true in Rotation.random(COUNT, rng=numbers):
    read = true * Rotation.from_rotvec(SCATTER * numbers.normal(size=(20, 3)))
    mean = qmean(np.roll(read.as_quat(), 1, axis=1), axis=0)  # order: real part first
    lengths.append(np.linalg.norm(mean))
    theirs.append(angle(Rotation.from_quat(np.roll(mean, -1)), true))
    ours.append(angle(read.mean(), true))
theirs = np.array(theirs)
wrong = np.mean(theirs > 1)
print(f"{COUNT} means of 20 orientations that scatter by {np.degrees(SCATTER):.3f} deg about each axis:")
print(f"  SciPy: off by up to {max(ours):.3f} deg")
print(f"  qmean: {100 * wrong:.0f} % off by more than 1 deg, half of all by more than {np.median(theirs):.0f}, the worst by {theirs.max():.0f} deg; lengths {min(lengths):.3f} to {max(lengths):.3f}")
unchanged = 0.4 < wrong < 0.9 and theirs.max() > 150 and max(ours) < 0.1 and np.allclose(lengths, 1, atol=1e-6)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
