#!/usr/bin/env bash
# Derivatives of poses that are not turned, in mink.
#
# Expected: SE3.jlog is the derivative of SE3.log by a small motion at any pose, and rjac and ljac that of exp.
# What happens: so it is from a turn of 1e-4 rad on, as far as differences can tell. Below 1e-5 rad all of
# them are the identity: the block that couples translation and turn, half the translation, is not there. Of a pose
# that is 1 m away and not turned, a turn of 1 mrad changes the log by 0.5 mm, as mink's own log says, and by 0
# by jlog. A pose with 1e-4 rad beside it has the right derivative, so that it jumps. Nothing is said.
# Whom it hurts: whoever takes covariances of relative poses or steps of a fit from it, or writes a task by it: motions
# along a rail or a linear axis, targets that are a pure shift away, and everything at a start from zero are just
# there. Steps of a solver still end where the error is zero; a covariance lacks its largest part.
# poecal: takes these derivatives by series at small turns, to the last digits of double precision.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check mink==1.3.0 mujoco==4.0.0 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from mink.lie import SE3, SO3

print("mink", version("mink"))
random = np.random.default_rng(1)
STEP = 1e-3


def by_differences(pose):
    """Derivative of log(pose exp(d)) at d = 0; exp of these d is exact to 1e-9."""
    columns = []
    for number in range(6):
        one = np.eye(6)[number]
        there = [pose.multiply(SE3.exp(sign * STEP * one)).log() for sign in (-2, -1, 1, 2)]
        columns.append((there[0] - 8 * there[1] + 8 * there[2] - there[3]) / (12 * STEP))
    return np.array(columns).T


def unit():
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


unchanged = True
print("turn, rad    jlog off by, largest entry   of it in the block translation by turn (poses 1 m away)")
for turn in (0.0, 1e-9, 1e-6, 9e-6, 1e-4, 1e-3, 0.1, 1.0):
    misses, blocks = [], []
    for _ in range(50):
        pose = SE3.from_rotation_and_translation(SO3.exp(turn * unit()), unit())
        apart = np.abs(pose.jlog() - by_differences(pose))
        misses.append(apart.max())
        blocks.append(apart[:3, 3:].max())
    print(f"{turn:9.3g} {max(misses):22.3g} {max(blocks):22.3g}")
    unchanged = unchanged and (0.4 < max(blocks) < 0.55 if turn < 1e-5 else max(misses) < 1e-6)
away = SE3.from_translation(np.array([1.0, 0.0, 0.0]))
turned = away.multiply(SE3.exp(np.array([0, 0, 0, 0, 0, 1e-3])))
print(f"pose 1 m along x, turned by 1 mrad about z: log changes by {1e6 * (turned.log() - away.log())[:3] + 0.0} um, by jlog {1e3 * away.jlog()[:3, 5] + 0.0} um")
print("jlog, rjac and ljac without turn are the identity:", all(np.array_equal(each, np.eye(6)) for each in (away.jlog(), SE3.rjac(away.log()), SE3.ljac(away.log()))))
unchanged = unchanged and np.array_equal(away.jlog(), np.eye(6)) and abs((turned.log() - away.log())[1] + 5e-4) < 1e-6
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
