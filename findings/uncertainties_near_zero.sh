#!/usr/bin/env bash
# The uncertainty of a pose with a joint near zero, by a function that uncertainties wraps.
#
# Expected: wrap(f) takes derivatives of f by differences: for a joint at 1e-9 rad as for one at 0 or at 0.1 rad, with
# some digits less.
# What happens: the step is 1.5e-8 of the value, and 1.5e-8 where the value is exactly 0. For a joint at 6e-17 rad,
# which is what a cosine of 90 degrees leaves, or up to 1e-9 rad, f does not change by such a step, and the
# uncertainty is exactly 0, or, where rounding makes f change, up to 89 times the true one. At 1e-7 rad it is 3 %
# off. Exactly 0 is right, so that a first test shows nothing. Nothing is said; the documentation of wrap speaks of
# no scale.
# Whom it hurts: whoever propagates errors of joints, offsets or corrections through a forward kinematics by it: at
# zero positions, and of corrections, which are small beside the lengths of an arm. Give derivatives, or wrap
# a function of the value plus one, which takes the one off again.
# poecal: takes derivatives of its models by formulas, at any value.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check uncertainties==3.2.3 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from uncertainties import ufloat, wrap

print("uncertainties", version("uncertainties"))
SIGMA = 1e-3


def height(shoulder, elbow):
    """Of the tool of an arm with links of 0.5 m and 0.4 m on a column of 0.7 m."""
    return 0.7 + 0.5 * np.sin(shoulder) + 0.4 * np.sin(shoulder + elbow)


wrapped = wrap(height)
shifted = wrap(lambda shoulder, elbow: height(shoulder, elbow - 1))
unchanged = True
print("elbow at, rad    uncertainty of the height by wrap, with the constant, true, um (elbow known to 1 mrad, shoulder at 0.3 rad)")
for value in (0.0, float(np.cos(np.pi / 2)), 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-3, 0.1):
    true = 0.4 * np.cos(0.3 + value) * SIGMA
    plain, helped = wrapped(0.3, ufloat(value, SIGMA)).std_dev, shifted(0.3, ufloat(value, SIGMA) + 1).std_dev
    print(f"{value:13.3g} {1e6 * plain:14.3f} {1e6 * helped:14.3f} {1e6 * true:14.3f}")
    unchanged = unchanged and abs(helped / true - 1) < 1e-5
    if 0 < value < 1e-9:
        unchanged = unchanged and plain == 0
    elif value == 0 or value >= 1e-3:
        unchanged = unchanged and abs(plain / true - 1) < 1e-4
ratios = np.array([wrapped(0.3, ufloat(value, SIGMA)).std_dev for value in np.geomspace(1e-10, 1e-8, 2001)]) / (0.4 * np.cos(0.3) * SIGMA)
print(f"2001 values from 1e-10 to 1e-8 rad: {100 * np.mean(ratios == 0):.0f} % have none, the largest has {ratios.max():.1f} times the true one")
unchanged = unchanged and np.mean(ratios == 0) > 0.3 and ratios.max() > 10
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
