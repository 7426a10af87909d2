"""Times the detection of a board by OpenCV, one thread, decoding apart: `opencv_peer.py BOARD PICTURE...`; prints as the example `speed` does."""

import sys
import time
from collections.abc import Callable

import cv2

SIZES = {"circles": (9, 6), "circles-asymmetric": (4, 11)}


def detector(board: str) -> Callable:
    """A function from a picture to the number of its corners."""
    aruco = cv2.aruco
    if board == "charuco":
        layout = aruco.CharucoBoard((7, 5), 0.036195, 0.018256, aruco.getPredefinedDictionary(aruco.DICT_6X6_250))
        charuco = aruco.CharucoDetector(layout)
        return lambda gray: count(charuco.detectBoard(gray)[0])
    if board.startswith("tags"):
        parameters = aruco.DetectorParameters()
        parameters.cornerRefinementMethod = aruco.CORNER_REFINE_APRILTAG
        family = aruco.DICT_APRILTAG_36h11 if board == "tags-36h11" else aruco.DICT_6X6_250
        tags = aruco.ArucoDetector(aruco.getPredefinedDictionary(family), parameters)
        return lambda gray: 4 * len(tags.detectMarkers(gray)[0])
    if board == "chessboard":
        return chessboard
    flags = cv2.CALIB_CB_ASYMMETRIC_GRID if board == "circles-asymmetric" else cv2.CALIB_CB_SYMMETRIC_GRID
    return lambda gray: count(found[1] if (found := cv2.findCirclesGrid(gray, SIZES[board], flags=flags))[0] else None)


def chessboard(gray: cv2.typing.MatLike) -> int:
    is_found, corners = cv2.findChessboardCorners(gray, (9, 6))
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 30, 0.01)
    return count(cv2.cornerSubPix(gray, corners, (5, 5), (-1, -1), stop)) if is_found else 0


def count(corners: cv2.typing.MatLike | None) -> int:
    return 0 if corners is None else len(corners)


def main() -> None:
    cv2.setNumThreads(1)
    detect = detector(sys.argv[1])
    paths = sys.argv[2:]
    seconds, found = 0.0, []
    for path in paths:
        gray = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
        start = time.thread_time()
        found.append(detect(gray))
        seconds += time.thread_time() - start
    print(f"{1e3 * seconds / len(paths):.2f} ms, {sum(it > 0 for it in found)} of {len(paths)} pictures, {sum(found)} corners")


main()
