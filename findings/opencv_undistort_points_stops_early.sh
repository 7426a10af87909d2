#!/usr/bin/env bash
# Pixels through undistortPoints and back through projectPoints, in OpenCV.
#
# Expected: the two are inverse to each other, to a hundredth of a pixel or better.
# What happens: undistortPoints stops after five rounds of a simple iteration, whatever is left. At the
# corners of a wide lens (70 degrees across) with k1 = -0.35 that is 0.8 px, with the eight numbers of a
# rational model 7 px, with fourteen 10 px; in the middle of the picture nothing. No warning, no status.
# Whom it hurts: whoever makes rays of pixels with it, triangulates, or fits to undistorted points. What
# is off lies at the rim, where corners of a board say most about a lens.
# What helps: criteria (undistortPointsIter in OpenCV 4) that ask for more rounds: exact to 1e-11 px. To
# fit in pixels, by projectPoints, needs no inverse at all.
# poecal: fits in pixels, and refuses lenses of twelve or fourteen numbers by name.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check opencv-python-headless==5.0.0.93 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import sys
import cv2
import numpy as np

print("OpenCV", cv2.__version__)
CAMERA = np.array([[900.0, 0, 640], [0, 905, 360], [0, 0, 1]])
RATIONAL = [0.3, -0.2, 0.001, 0.0005, 0.05, 0.6, -0.1, 0.02]
LENSES = {
    "little distortion": ([-0.1, 0.02, 0, 0, 0], 0, 0.01),
    "five numbers": ([-0.35, 0.12, 0.001, -0.0005, -0.01], 0.5, 1),
    "eight numbers": (RATIONAL, 5, 9),
    "fourteen numbers": ([*RATIONAL, 0.001, -0.0005, 0.002, 0.0003, 0.02, -0.03], 7, 12),
}
grid = np.stack(np.meshgrid(np.linspace(0, 1279, 9), np.linspace(0, 719, 7)), -1).reshape(-1, 1, 2)


def error(rays, lens):
    """The largest distance of a pixel from itself after both ways."""
    points = cv2.convertPointsToHomogeneous(rays)
    return np.abs(cv2.projectPoints(points, np.zeros(3), np.zeros(3), CAMERA, lens)[0] - grid).max()


unchanged = True
until = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)
print("largest error in a picture of 1280 x 720, px   as it is   with criteria")
for name, (lens, least, most) in LENSES.items():
    lens = np.array(lens)
    plain = error(cv2.undistortPoints(grid, CAMERA, lens), lens)
    exact = error(cv2.undistortPoints(grid, CAMERA, lens, None, None, None, until), lens)
    print(f"  {name:42} {plain:10.4f}   {exact:.0e}")
    unchanged = unchanged and least <= plain < most and exact < 1e-9
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
