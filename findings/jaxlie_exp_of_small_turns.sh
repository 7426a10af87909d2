#!/usr/bin/env bash
# The exponential of a twist with a small turn and a translation, in jaxlie.
#
# Expected: SE3.exp has the precision of its numbers, 1e-7 in the float32 that JAX takes by default; for
# small turns by a series.
# What happens: below 3.2e-3 rad (0.18 degrees) in float32, and 1e-5 rad in float64, the translation
# turns with the whole rotation, not with half of it as it does along a screw. The error is half the turn
# times the translation: 1.5 mm for 1 m. The derivative of the translation by the turn is twice the true
# one there, in float64 too. SE3.log is right, so log(exp(x)) is not x. Just above it is all as expected.
# Whom it hurts: whoever optimizes screws, offsets or poses from zero by gradients, since a calibration
# lives in just these turns. A step from a pose by a small twist from zero (v = 0, w = 0) has the right
# derivative.
# poecal: its exponential is a series there, exact to the last digits in double precision.
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
from scipy.spatial.transform import RigidTransform

print("jaxlie", version("jaxlie"), "and jax", version("jax"))
AXIS, SLIDE = np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.0, 0.0])   # at right angles: the largest error


def exact(turn, slide):
    return RigidTransform.from_exp_coords(np.r_[turn, slide]).translation


def errors(angle):
    """Errors of the translation of 1 m, of log(exp), and of the derivative of the translation by the turn about the axis."""
    twist = jax.numpy.asarray(np.r_[SLIDE, angle * AXIS])
    pose = jaxlie.SE3.exp(twist)
    along = jax.jvp(lambda x: jaxlie.SE3.exp(x).translation(), (twist,), (jax.numpy.asarray(np.r_[np.zeros(3), AXIS]),))[1]
    step = 1e-4   # central differences of the exact function are good to 1e-8 here
    slope = (exact((angle + step) * AXIS, SLIDE) - exact((angle - step) * AXIS, SLIDE)) / (2 * step)
    translation = np.asarray(pose.translation(), float) - exact(angle * AXIS, SLIDE)
    return [np.linalg.norm(error) for error in (translation, np.asarray(pose.log() - twist), np.asarray(along, float) - slope)]


unchanged = True
for double, limit, fine in ((False, 3.2e-3, 1e-3), (True, 1e-5, 1e-7)):
    jax.config.update("jax_enable_x64", double)
    print("float64" if double else "float32, the default")
    print("  turn, rad   error of the translation   of log(exp(x))   of its derivative, about 0.5")
    for angle in (1e-6, 1e-4, 3e-3, 1e-2, 1.0):
        translation, around, derivative = errors(angle)
        print(f"  {angle:9.0e}   {translation:24.1e}   {around:14.1e}   {derivative:17.1e}")
        if angle < limit:
            unchanged = unchanged and abs(translation / (angle / 2) - 1) < 0.2 and around > 0.4 * angle and abs(derivative - 0.5) < 0.01
        else:
            unchanged = unchanged and max(translation, around, derivative) < fine
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
