#!/usr/bin/env bash
# The derivative of the logarithm of a pose, jlog, in jaxlie.
#
# Expected: SE3.jlog is the derivative that automatic differentiation of log(pose @ exp(d)) gives, to
# about 1e-6 in float32.
# What happens: so it is at a turn of zero and from about 0.1 rad on. Between, the block that couples
# the translation to the turn is a difference of large numbers. In float32, the default, it is wrong by
# hundredths at 0.6 degrees and by more than a tenth, sometimes wholly, at 0.2 degrees; in float64 by
# hundredths at 1e-5 rad. Automatic differentiation of the same expression is right all along.
# Whom it hurts: whoever uses jlog for Jacobians or covariances of small errors of poses, for which it is
# there. A solver still ends where the error vanishes, by more steps; a covariance is simply wrong.
# poecal: takes the same derivative by series at small turns, to the last digits of double precision.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check jaxlie==1.5.0 jax==0.10.2 jaxlib==0.10.2 numpy==2.4.6 scipy==1.17.1
JAX_PLATFORMS=cpu "$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import jax
import jaxlie
import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

print("jaxlie", version("jaxlie"), "and jax", version("jax"))


def worst(angle):
    """The largest errors of an element of the derivative over 8 poses at 1 m: of jlog, and of automatic differentiation."""
    random, errors = np.random.default_rng(1), np.zeros(2)
    for axis, position in random.normal(size=(8, 2, 3)):
        turn, position = angle * axis / np.linalg.norm(axis), position / np.linalg.norm(position)
        exact = RigidTransform.from_components(position, Rotation.from_rotvec(turn))
        x, y, z, w = exact.rotation.as_quat()
        pose = jaxlie.SE3(jax.numpy.asarray([w, x, y, z, *position]))

        def log(step):   # translation first, as jaxlie has it
            return np.roll((exact * RigidTransform.from_exp_coords(np.roll(step, 3))).as_exp_coords(), 3)

        steps = 1e-5 * np.eye(6)
        slopes = np.array([(log(step) - log(-step)) / 2e-5 for step in steps]).T
        automatic = jax.jacfwd(lambda step: (pose @ jaxlie.SE3.exp(step)).log())(jax.numpy.zeros(6))
        errors = np.maximum(errors, [np.abs(np.asarray(x, float) - slopes).max() for x in (pose.jlog(), automatic)])
    return errors


rows = {}
for double in (False, True):
    jax.config.update("jax_enable_x64", double)
    print("float64" if double else "float32, the default", "\n  turn, rad    error of jlog   of automatic differentiation")
    for angle in (1.1e-5, 1e-3, 3.5e-3, 1e-2, 0.1, 1.0):
        rows[double, angle] = jlog, automatic = worst(angle)
        print(f"  {angle:9.1e}    {jlog:13.1e}   {automatic:28.1e}")
unchanged = all(automatic < 1e-3 for _, automatic in rows.values()) and max(rows[False, 1.0][0], rows[True, 1e-2][0]) < 1e-5
unchanged = unchanged and rows[False, 3.5e-3][0] > 0.1 and rows[False, 1e-2][0] > 1e-3 and rows[True, 1.1e-5][0] > 1e-3
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
