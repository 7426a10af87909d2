"""Hand-eye and robot-world calibration by OpenCV, on the pictures that poecal has, judged by corners that were held out."""
import csv
import json
import math
from collections import defaultdict

try:
    import cv2
    import numpy as np

    if not hasattr(cv2, "calibrateHandEye"):
        cv2 = None
except ImportError:
    cv2 = None

HAND_EYE = ("TSAI", "PARK", "HORAUD", "ANDREFF", "DANIILIDIS")
ROBOT_WORLD = ("SHAH", "LI")
# About so many fitted pictures at most: some methods take all pairs, and the time of their squares.
MOST = 100


def pose(rotation, translation):
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = np.asarray(rotation, float).reshape(3, 3), np.asarray(translation, float).ravel()
    return found


def mean(poses):
    left, _, right = np.linalg.svd(sum(it[:3, :3] for it in poses))
    flip = np.diag([1.0, 1.0, np.linalg.det(left @ right)])
    return pose(left @ flip @ right, sum(it[:3, 3] for it in poses) / len(poses))


class Pictures:
    """Pictures of one camera: of each the tip's pose, the corners' points and pixels, and whether it is held out."""

    def __init__(self, matrix, distortion, board, in_hand):
        self.matrix, self.distortion, self.board, self.in_hand = np.array(matrix), np.array(distortion), np.array(board), in_hand
        self.fitted, self.held_out = [], []

    def add(self, tip, points, pixels, held_out):
        points, pixels = self.board[points], np.array(pixels)
        (self.held_out if held_out else self.fitted).append((tip, points, pixels))

    def seen(self, points, pixels):
        """The pose of the board in the camera's frame, as OpenCV finds it."""
        flat = np.ptp(points[:, 2]) < 1e-9
        flag = cv2.SOLVEPNP_IPPE if flat else cv2.SOLVEPNP_SQPNP
        count, turns, shifts, errors = cv2.solvePnPGeneric(points, pixels, self.matrix, self.distortion, flags=flag)
        best = min(range(count), key=lambda at: float(np.asarray(errors[at]).item()))
        turn, shift = cv2.solvePnPRefineLM(points, pixels, self.matrix, self.distortion, turns[best], shifts[best])
        return pose(cv2.Rodrigues(turn)[0], shift)

    def methods(self):
        """By the name of a method, the pose of the board in the camera's frame by the tip's."""
        every = max(1, len(self.fitted) // MOST)
        moving = [(tip if self.in_hand else np.linalg.inv(tip), self.seen(points, pixels)) for tip, points, pixels in self.fitted[::every]]
        ahead = [it[0] for it in moving]
        seen = [it[1] for it in moving]
        parts = lambda poses: ([it[:3, :3] for it in poses], [it[:3, 3] for it in poses])
        for name in HAND_EYE:
            turn, shift = cv2.calibrateHandEye(*parts(ahead), *parts(seen), method=getattr(cv2, f"CALIB_HAND_EYE_{name}"))
            camera = pose(turn, shift)
            board = mean([a @ camera @ s for a, s in moving])
            yield name, lambda tip, camera=camera, board=board: np.linalg.inv(self.ahead(tip) @ camera) @ board
        back = [np.linalg.inv(it) for it in ahead]
        for name in ROBOT_WORLD:
            found = cv2.calibrateRobotWorldHandEye(*parts(seen), *parts(back), method=getattr(cv2, f"CALIB_ROBOT_WORLD_HAND_EYE_{name}"))
            world, camera = pose(*found[:2]), pose(*found[2:])
            yield name, lambda tip, camera=camera, world=world: camera @ np.linalg.inv(self.ahead(tip)) @ np.linalg.inv(world)

    def ahead(self, tip):
        return tip if self.in_hand else np.linalg.inv(tip)

    def squares(self, predict):
        """Squared distances of the corners that were held out."""
        found = []
        for tip, points, pixels in self.held_out:
            at = predict(tip)
            shown, _ = cv2.projectPoints(points, cv2.Rodrigues(at[:3, :3])[0], at[:3, 3], self.matrix, self.distortion)
            found += list(((shown.reshape(-1, 2) - pixels) ** 2).sum(axis=1))
        return found


def held_out_px(cameras):
    """By the name of a method, the root mean square distance of the corners of all cameras."""
    squares = defaultdict(list)
    for camera in cameras:
        for name, predict in camera.methods():
            squares[name] += camera.squares(predict)
    return {name: math.sqrt(sum(own) / len(own)) for name, own in squares.items()}


def of_simulated(row):
    (fx, fy), (cx, cy) = row["lens"]["focal"], row["lens"]["centre"]
    pictures = Pictures([[fx, 0, cx], [0, fy, cy], [0, 0, 1]], np.zeros(5), row["board"], row["in_hand"])
    for picture in row["pictures"]:
        corners = np.array(picture["corners"])
        tip = pose(picture["tip"]["rotation"], picture["tip"]["translation"])
        pictures.add(tip, corners[:, 0].astype(int), corners[:, 1:], picture["held_out"])
    return held_out_px([pictures])


# Name, robot, further words, board, version of the cameras, and whether the camera is in the hand.
PUBLIC = {
    "UR10e, eye in hand": ("ur10e_eye_in_hand", "robot.urdf", ["--base-link", "base_link", "--tip-link", "wrist_3_link"], "board.csv", "", 1.0, True),
    "UR3e, eye in hand": ("ur3e_eye_in_hand", "robot.urdf", ["--base-link", "base_link", "--tip-link", "wrist_3_link"], "board.csv", "", 14.6 / 26.2, True),
    "MA1400, two cameras": ("motoman", "robot_left_marker.urdf", [], "markers.csv", "axes_swapped", 1.0, False),
}


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def of_public(runs):
    """Name, held-out pixels of poecal, and those of each method, of the public sessions that are there."""
    for name, (folder, robot, links, board, version, scale, in_hand) in PUBLIC.items():
        folder = runs.datasets / folder
        if not folder.is_dir():
            print(f"{name}: skipped, no {folder}")
            continue
        pixels = folder / ("pixels.csv" if in_hand else "pixels_left.csv")
        points = table(folder / board)
        with open(runs.folder / "board.csv", "w", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(["target", "x[mm]", "y[mm]", "z[mm]"])
            names = [it.get("target") or f"marker{it['marker']}" for it in points]
            places = [[scale * float(it[f"{axis}_mm"]) for axis in "xyz"] for it in points]
            rows.writerows([at, *place] for at, place in zip(names, places))
        cameras = f"{folder / 'cameras.csv'}{'#' + version if version else ''}"
        out = runs.folder / "out"
        words = ["--camera", cameras, "--markers", runs.folder / "board.csv", "--fix", "joints", "--out", out, "--force", "--quiet", "--report", "none"]
        done = runs.run("calibrate", folder / robot, pixels, *links, *words)
        if not (out / "calibration.json").is_file():
            raise SystemExit(f"{name}: {done.stderr}")
        ours = json.loads((out / "calibration.json").read_text())["accuracy"]["held_out"]["calibrated"]["pixels"]
        (out / "calibration.json").unlink()
        others = of_table(runs, (folder, robot, links, version), (pixels, names, places), in_hand)
        yield f"{name} ({ours['pictures']} held out)", ours["rms_px"], others


def of_table(runs, model, corners, in_hand):
    """Held-out pixels of OpenCV's methods, each camera for itself."""
    folder, robot, links, version = model
    pixels, names, places = corners
    rows = table(pixels)
    poses = list(csv.DictReader(runs.run("predict", folder / robot, pixels, *links, "--quiet").stdout.splitlines()))
    groups, tips = defaultdict(list), {}
    for row, at in zip(rows, poses):
        groups[row["camera"], row["id"]].append(row)
        x, y, z, w = (float(at[key]) for key in ("qx", "qy", "qz", "qw"))
        turn = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
        tips[row["id"]] = pose(turn, [float(at[f"{axis}[m]"]) for axis in "xyz"])
    lenses = [it for it in table(folder / "cameras.csv") if it["version"] == version or not version]
    found = {}
    for (camera, row), own in groups.items():
        if len(own) < 4:
            continue
        if camera not in found:
            lens = next(it for it in lenses if it["name"] == camera or it["name"] == camera.split("_")[0])
            fx, fy, cx, cy = (float(lens[key]) for key in ("fx", "fy", "cx", "cy"))
            distortion = [float(lens[key]) for key in ("k1", "k2", "p1", "p2", "k3")]
            found[camera] = Pictures([[fx, 0, cx], [0, fy, cy], [0, 0, 1]], distortion, 1e-3 * np.array(places), in_hand)
        at = [names.index(it["target"]) for it in own]
        found[camera].add(tips[row], at, [[float(it["u[px]"]), float(it["v[px]"])] for it in own], own[0]["set"] != "fit")
    return held_out_px(found.values())
