#!/usr/bin/env bash
# The uncertainty that robotkinecal states for the joints of an arm calibrated by points.
#
# Expected: variances by the residuals over the degrees of freedom, three numbers a point less the parameters: on average
# the true ones, and none where there are as many parameters as numbers.
# What happens: degrees of freedom are six a row less the parameters also where rows are points. For six joints and a
# point, 27 parameters, joints_uncertainty is 11 times too small on average for 10 points, 5 times for 12, and never
# better than 2 times. For 9 points, which fit whatever was measured, it is zero. With poses it is right. It
# is a norm of variances in rad² and m², too, not of standard deviations, which the word and print() do not say.
# Whom it hurts: whoever stops measuring when it is small enough, or compares joints of two arms: the smallest sets of
# points look the most certain. Multiply by (6 n - p) / (3 n - p).
# poecal: the noise that its bounds follow from has the degrees of freedom of the numbers measured.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check robotkinecal==0.1.0 roboticstoolbox-python==1.4.4 spatialmath-python==1.1.18 numpy==1.26.4 scipy==1.17.1
HOME=$here "$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from roboticstoolbox import ET, ERobot, Link
from robotkinecal import SerialRobotKineCal
from spatialmath import SE3

print("robotkinecal", version("robotkinecal"))
NOISE = 2e-5
numbers = np.random.default_rng(1)
np.random.seed(1)  # seed of the library's basis of each joint


def arm():
    stages = [
        ET.tz(0.4) * ET.Rz(), ET.Rx(-np.pi / 2) * ET.Rz(), ET.tx(0.5) * ET.Rz(), ET.tx(0.05) * ET.Rx(-np.pi / 2) * ET.tz(0.3) * ET.Rz(),
        ET.Rx(np.pi / 2) * ET.Rz(), ET.Rx(-np.pi / 2) * ET.Rz(), ET.tx(0.06) * ET.ty(0.03) * ET.tz(0.15)]
    links = []
    for number, stage in enumerate(stages, 1):
        links.append(Link(stage, name=f"link{number}", parent=links[-1] if links else None))
    return ERobot(links, name="arm")


def ratios(count, poses):
    """Stated over true variances: these follow from the noise, which is known here, and the same matrix."""
    true, fitted = SerialRobotKineCal(arm(), "link7"), SerialRobotKineCal(arm(), "link7")
    joints = numbers.uniform(-2, 2, (count, 6))
    seen = [true.forward_kinematics(7, q) for q in joints]
    if poses:
        # Twists of the poses have the same noise in all six numbers, which is what the library assumes.
        seen = [SE3(SE3.Exp(NOISE * numbers.normal(size=6)).A @ pose.A) for pose in seen]
    else:
        seen = [pose.t + NOISE * numbers.normal(size=3) for pose in seen]
    fitted.set_observations(joints, seen)
    last = fitted.solve().iteration_results[-1]
    variances = NOISE**2 * np.diag(np.linalg.inv(last.A_all.T @ last.A_all))[:24]
    return last.get_statistics()["joints_uncertainty"] / np.linalg.norm(variances.reshape(6, 4), axis=1)


unchanged = True
for count, poses in ((9, False), (10, False), (12, False), (20, False), (60, False), (12, True), (60, True)):
    parameters = 30 if poses else 27
    expected = 1 if poses else (3 * count - parameters) / (6 * count - parameters)
    found = np.mean([ratios(count, poses) for _ in range(40)])
    print(f"  {count:2} {'poses ' if poses else 'points'}: stated over true variances {found:.3f} on average" + ("" if poses else f", as 3 n - p over 6 n - p: {expected:.3f}"))
    unchanged = unchanged and abs(found - expected) < max(0.15 * expected, 1e-6) + (0.03 if count == 10 else 0)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
