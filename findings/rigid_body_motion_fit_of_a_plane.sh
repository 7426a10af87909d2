#!/usr/bin/env bash
# The rotation between directions that lie in one plane, by rigid-body-motion.
#
# Expected: best_fit_rotation returns the rotation that turns one set of vectors into the other with the least squares, as
# its documentation says; two directions that are not parallel determine it, and so do many in a plane.
# What happens: of the two orthogonal matrices that fit vectors in a plane equally well one is a reflection, and nothing
# chooses between them, unlike in best_fit_transform of the same module. In half of all cases it is the reflection,
# which is then made a quaternion: a rotation that does not fit even exact vectors, by up to half a turn.
# Neither a warning nor the length of the quaternion tells.
# Whom it hurts: whoever finds the orientation of a sensor from directions of gravity, of lines or of a beam while one
# joint turns, as those are in a plane or nearly so: a coin decides. best_fit_transform is right if the
# vectors' means are zero, or use SciPy's Rotation.align_vectors.
# poecal: rotations between sets of points or directions are proper ones also in a plane.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check rigid-body-motion==0.9.3 numpy-quaternion==2024.0.13 numpy==2.4.6 scipy==1.17.1
HOME=$here "$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from rigid_body_motion import best_fit_rotation
from scipy.spatial.transform import Rotation

print("rigid-body-motion", version("rigid-body-motion"))
numbers = np.random.default_rng(1)
COUNT = 500


def angle(one, other):
    return np.degrees((one.inv() * other).magnitude())


unchanged = True
for name, height, noise in (("in a plane, exact", 0.0, 0.0), ("in a plane, noise of 0.001", 0.0, 1e-3), ("on a cone of 45 deg, noise of 0.001", 1.0, 1e-3)):
    theirs, ours = [], []
    for true, view in zip(Rotation.random(COUNT, rng=numbers), Rotation.random(COUNT, rng=numbers)):
        around = numbers.uniform(-2, 2, 20)
        directions = np.c_[np.cos(around), np.sin(around), np.full(20, height)]
        directions = view.apply(directions / np.linalg.norm(directions[0]))
        seen = true.apply(directions) + noise * numbers.normal(size=(20, 3))
        theirs.append(angle(Rotation.from_quat(np.roll(best_fit_rotation(directions, seen), -1)), true))
        ours.append(angle(Rotation.align_vectors(seen, directions)[0], true))
    wrong = np.mean(np.array(theirs) > 1)
    print(f"{COUNT} sets of 20 directions {name}:")
    print(f"  best_fit_rotation: {100 * wrong:.0f} % off by more than 1 deg, the worst by {max(theirs):.1f} deg; SciPy: the worst by {max(ours):.3f} deg")
    unchanged = unchanged and max(ours) < 0.5 and (0.35 < wrong < 0.65 and max(theirs) > 150 if height == 0 else wrong == 0)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
