#!/usr/bin/env bash
# A robot calibrated with the residual of pybotics and least_squares of SciPy.
#
# Expected: least_squares on optimize_accuracy finds the DH parameters that the points determine; with
# points free of noise, all digits of them.
# What happens: optimize_accuracy gives one number for each point, the length of its error, instead of
# the three components. The optimum is the same, but Gauss-Newton steps are not: a length has a kink
# where it is zero, and the direction of an error is lost. The solver reports convergence early, with a
# sum of squares above the optimum and twice the error of predictions that the points allow.
# Whom it hurts: whoever trusts "converged". With the components as residuals the same solver goes on.
# poecal: residuals are components, whitened by their noise, with exact derivatives.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pybotics==3.1.2 numpy==1.26.4 scipy==1.14.1
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from pybotics.optimization import OptimizationHandler, optimize_accuracy
from pybotics.predefined_models import ur10
from pybotics.robot import Robot
from scipy.optimize import least_squares

print("pybotics", version("pybotics"), "and scipy", version("scipy"))
random = np.random.default_rng(1)
nominal, actual = Robot.from_parameters(ur10()), Robot.from_parameters(ur10())
nominal.tool.position = actual.tool.position = [0.0, 50.0, 100.0]
errors = random.normal(size=24) * np.tile([5e-4, 0.5, 5e-4, 0.5], 6)   # alpha, a, theta, d of each row: rad, mm
errors[:4] = 0                                                         # the first row is where the tracker is
actual.kinematic_chain.vector = actual.kinematic_chain.vector + errors
free = [False] * 4 + [True] * 20
joints, others = random.uniform(-2, 2, (60, 6)), random.uniform(-2, 2, (200, 6))
exact = np.array([actual.fk(q)[:3, 3] for q in joints])


def components(vector, handler, joints, positions):
    handler.apply_optimization_vector(vector)
    return (positions - np.array([handler.robot.fk(q)[:3, 3] for q in joints])).ravel()


def calibrated(residual, noise_mm, random):
    """Rounds, sum of squares, and RMS error in mm of the tool in configurations that were not measured."""
    handler = OptimizationHandler(robot=nominal, kinematic_chain_mask=free)
    points = exact + random.normal(size=exact.shape) * noise_mm
    done = least_squares(residual, handler.generate_optimization_vector(), args=(handler, joints, points))
    handler.apply_optimization_vector(done.x)
    miss = [np.linalg.norm(handler.robot.fk(q)[:3, 3] - actual.fk(q)[:3, 3]) for q in others]
    return done.success, done.nfev, 2 * done.cost, np.sqrt(np.mean(np.square(miss)))


rows = {(noise, name): calibrated(residual, noise, np.random.default_rng(2))
        for noise in (0.0, 0.05) for name, residual in (("lengths", optimize_accuracy), ("components", components))}
print("noise, mm   residuals    converged   rounds   sum of squares, mm2   error of predictions, mm")
for (noise, name), (success, rounds, squares, miss) in rows.items():
    print(f"{noise:9}   {name:10}   {success!s:9}   {rounds:6}   {squares:19.3e}   {miss:.2e}")
lengths, optimum = rows[0.05, "lengths"], rows[0.05, "components"]
unchanged = lengths[0] and lengths[2] > 1.01 * optimum[2] and lengths[3] > 1.2 * optimum[3]
unchanged = unchanged and rows[0.0, "lengths"][0] and rows[0.0, "lengths"][3] > 5 * rows[0.0, "components"][3]
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
