#!/usr/bin/env bash
# Corners of markers that OpenCV refines as AprilTag does, beside those that it refines as subpixels.
#
# Expected: all ways of cv2.aruco give corners in OpenCV's own convention, where the middle of the first
# pixel is (0, 0), which projectPoints, solvePnP and calibrateCamera share.
# What happens: with CORNER_REFINE_APRILTAG all corners lie about 0.4 px further right and further down.
# AprilTag's own programs count from the corner of the first pixel, half a pixel away, and most of that
# came along. Corners of CORNER_REFINE_SUBPIX have no such shift; pupil-apriltags has all of it.
# Whom it hurts: whoever mixes corners of both, or uses a lens that was calibrated by chessboards: the
# camera turns by 0.6 px, which is 0.6 mm at 1 m with a focal length of 1000 px, and no residual shows it.
# poecal: its own detector is within 0.01 px here. In a file of corners such a shift goes into the
# pose of the camera, which is fitted with the arm, as long as that pose is not stated.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check opencv-contrib-python-headless==5.0.0.93 pupil-apriltags==1.0.4.post11 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import cv2
import numpy as np
from pupil_apriltags import Detector

print("OpenCV", cv2.__version__, "and pupil-apriltags", version("pupil-apriltags"))
CELL, RIM = 20, 40
TAGS = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
sheet = np.pad(cv2.aruco.generateImageMarker(TAGS, 7, 8 * CELL), RIM, constant_values=255)
square = np.array([[RIM, RIM], [RIM + 8 * CELL, RIM], [RIM + 8 * CELL, RIM + 8 * CELL], [RIM, RIM + 8 * CELL]], float)
random = np.random.default_rng(1)


def picture(size=(360, 480), fine=6):
    """The tag as a camera sees it: each pixel is the mean of 36 points. And its corners in OpenCV's convention."""
    angle, scale = random.uniform(0, 0.7), random.uniform(0.6, 0.9)
    view = np.array([[scale * np.cos(angle), -scale * np.sin(angle), random.uniform(170, 200)],
                     [scale * np.sin(angle), scale * np.cos(angle), random.uniform(30, 60)], [*random.uniform(-3e-4, 3e-4, 2), 1]])
    y, x = (np.mgrid[: size[0] * fine, : size[1] * fine] + 0.5) / fine   # from the corner of the first pixel
    a, b, c = np.tensordot(np.linalg.inv(view), np.stack([x, y, np.ones_like(x)]), 1)
    column, row = (np.floor(part / c).astype(int) for part in (a, b))
    inside = (column >= 0) & (row >= 0) & (column < sheet.shape[1]) & (row < sheet.shape[0])
    grey = np.where(inside, sheet[row * inside, column * inside], 200.0) * 0.7 + 30
    grey = grey.reshape(size[0], fine, size[1], fine).mean((1, 3)).round().astype(np.uint8)
    seen = np.c_[square, np.ones(4)] @ view.T
    return grey, seen[:, :2] / seen[:, 2:] - 0.5


def by_opencv(method):
    settings = cv2.aruco.DetectorParameters()
    settings.cornerRefinementMethod = method
    return lambda grey: cv2.aruco.ArucoDetector(TAGS, settings).detectMarkers(grey)[0][0][0]


pupil = Detector(families="tag36h11", quad_decimate=1.0)
WAYS = {"OpenCV, subpixels": by_opencv(cv2.aruco.CORNER_REFINE_SUBPIX), "OpenCV, AprilTag": by_opencv(cv2.aruco.CORNER_REFINE_APRILTAG),
        "pupil-apriltags": lambda grey: pupil.detect(grey)[0].corners}
shifts = {name: [] for name in WAYS}
for _ in range(16):
    grey, truth = picture()
    for name, way in WAYS.items():
        found = np.asarray(way(grey))
        shifts[name].append([found[np.linalg.norm(found - corner, axis=1).argmin()] - corner for corner in truth])
print("mean shift of 64 corners from the truth, px: right and down")
for name, rows in shifts.items():
    shifts[name] = np.mean(rows, axis=(0, 1))
    print(f"  {name:18} {shifts[name][0]:+.3f} {shifts[name][1]:+.3f}")
plain, tag, pupil = (np.array(shift) for shift in shifts.values())
unchanged = np.abs(plain).max() < 0.1 and tag.min() > 0.3 and tag.max() < 0.6 and pupil.min() > 0.4 and pupil.max() < 0.6
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
