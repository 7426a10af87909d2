#!/usr/bin/env bash
# An AprilTag as its makers print it and as OpenCV prints it, read by both.
#
# Expected: DICT_APRILTAG_36h11 and tag36h11 are one family: a tag of one number has one upright, so that its frame
# and corners are the same in both, up to their order.
# What happens: each of the 587 tags of OpenCV is the makers' tag turned by half a turn. Both libraries read both prints
# with the right number, and either calls its own print upright: on a print of the makers OpenCV's first corner, the
# upper left one, is the lower right, and on one of OpenCV pupil-apriltags' lower left corner is the upper right. The
# frame of upright tags is another one too, which is documented: z out of the tag, or into it with y down. In all, poses of
# one tag by both are a half turn about y apart.
# Whom it hurts: whoever prints tags from one source and reads them by the other, or takes a pose from one and corners
# from the other: what is fixed beside the tag's centre, such as a board's other tags or the tip of a tool, is
# sought on its other side. The position of the centre is right, and nothing is said.
# poecal: means OpenCV's upright, which its own prints have, and says so (docs/file-formats.md, boards in words).
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check opencv-python-headless==5.0.0.93 pupil-apriltags==1.0.4.post11 numpy==2.4.6
"$here/venv/bin/pip" install -q --disable-pip-version-check --no-deps moms-apriltag==2023.1.15
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import cv2
import moms_apriltag
import numpy as np
from pupil_apriltags import Detector

print(f"OpenCV {cv2.__version__}, pupil-apriltags {version('pupil-apriltags')}, prints of the makers by moms-apriltag {version('moms-apriltag')}")
TAGS = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
MAKERS = moms_apriltag.TagGenerator2("tag36h11")
TURNED = {0: "as OpenCV's", 1: "a quarter", 2: "half a turn", 3: "three quarters"}


def of_opencv(number):
    return cv2.aruco.generateImageMarker(TAGS, number, 8)


def of_makers(number):
    return np.where(MAKERS.generate(number) > 0, 255, 0).astype(np.uint8)


turns = [turn for number in range(587) for turn in TURNED if np.array_equal(of_makers(number), np.rot90(of_opencv(number), turn))]
print("the makers' prints:", ", ".join(f"{turns.count(turn)} of 587 {words}" for turn, words in TURNED.items() if turn in turns))
unchanged = turns == [2] * 587


def place(corner):
    return f"{'upper' if corner[1] < 200 else 'lower'} {'left' if corner[0] < 200 else 'right'}"


by_opencv, by_makers = cv2.aruco.ArucoDetector(TAGS), Detector(families="tag36h11", quad_decimate=1.0)
camera = np.array([[500.0, 0, 200], [0, 500, 200], [0, 0, 1]])
corners_of_tag = 0.04 * np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]])
print("first corner as it is named, where it is in the picture, and what is x, y, z of the tag in the camera")
for name, draw, expected in (("OpenCV", of_opencv, ("upper left", "upper right")), ("the makers", of_makers, ("lower right", "lower left"))):
    for number in (0, 5, 586):
        picture = np.full((400, 400), 255, np.uint8)
        picture[120:280, 120:280] = np.kron(draw(number), np.ones((20, 20), np.uint8))
        corners, numbers, _ = by_opencv.detectMarkers(picture)
        one = corners[0][0]
        other, = by_makers.detect(picture, estimate_tag_pose=True, camera_params=(500.0, 500.0, 200.0, 200.0), tag_size=0.08)
        assert numbers.ravel().tolist() == [other.tag_id] == [number]
        turn = cv2.Rodrigues(cv2.solvePnP(corners_of_tag, one.astype(float), camera, None, flags=cv2.SOLVEPNP_IPPE_SQUARE)[1])[0]
        found = place(one[0]), place(other.corners[0])
        axes = [np.diag(it).round().astype(int) for it in (turn, other.pose_R)]
        unchanged = unchanged and found == expected and np.array_equal(axes[0], axes[1] * [-1, 1, -1])
        if number == 5:
            print(f"  print of {name:10} OpenCV, upper left: {found[0]} {axes[0]}   pupil-apriltags, lower left: {found[1]} {axes[1]}")
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
