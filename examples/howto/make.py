"""Makes the recordings of docs/howto: the elbow of examples/elbow with errors of its axes, seen by instruments of three kinds.

    python make.py POECAL FOLDER        with NumPy, and mcap for the bag

POECAL is the program, FOLDER is written into. All is simulated; every random number follows from SEED.
"""

import csv
import random
import struct
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import numpy as np

SEED = 7
MODEL = Path(__file__).resolve().parents[1] / "elbow" / "robot.toml"
LIMITS = [(-180, 180), (-105, 175), (-235, 85), (-180, 180), (-40, 220), (-360, 360)]
JOINTS = [f"joint{k}[deg]" for k in range(1, 7)]


def rotation(vector):
    """The matrix of a rotation vector."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    x, y, z = np.asarray(vector) / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def quaternion(matrix):
    """The quaternion x, y, z, w of a rotation matrix."""
    values, vectors = np.linalg.eigh(
        np.array(
            [
                [matrix[0, 0] - matrix[1, 1] - matrix[2, 2], 0, 0, 0],
                [matrix[1, 0] + matrix[0, 1], matrix[1, 1] - matrix[0, 0] - matrix[2, 2], 0, 0],
                [matrix[2, 0] + matrix[0, 2], matrix[2, 1] + matrix[1, 2], matrix[2, 2] - matrix[0, 0] - matrix[1, 1], 0],
                [matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1], np.trace(matrix)],
            ]
        )
    )
    found = vectors[:, -1]
    return found if found[3] >= 0 else -found


def rotation_vector(matrix):
    """The rotation vector of a matrix."""
    found = quaternion(matrix)
    size = np.linalg.norm(found[:3])
    return 2 * np.arctan2(size, found[3]) * found[:3] / size


def pose(turn, place):
    """A pose as a 4×4 matrix."""
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = rotation(turn), place
    return found


class Simulated:
    """The actual robot, and random numbers."""

    def __init__(self, poecal, folder):
        self.poecal, self.folder = poecal, Path(folder)
        self.random = random.Random(SEED)
        self.run("simulate", MODEL, "--errors", "0.2deg,0.5mm", "--seed", SEED, "--count", 1, "--out", self.folder / "robot")

    def run(self, *words):
        return subprocess.run([self.poecal, *map(str, words), "--quiet"], check=True, capture_output=True, text=True).stdout

    def configuration(self, share=0.95):
        """One within the middle of the joints' ranges."""
        return [round(self.random.uniform(low, high) * share + (1 - share) * (low + high) / 2, 4) for low, high in LIMITS]

    def tips(self, configurations):
        """The actual poses of the tip in the base, m."""
        table = self.folder / "joints.csv"
        with table.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([JOINTS, *configurations])
        rows = list(csv.reader(self.run("predict", self.folder / "robot" / "actual.toml", table).splitlines()))[1:]
        poses = []
        for row in rows:
            x, y, z, qx, qy, qz, qw = map(float, row)
            angle = 2 * np.arctan2(np.linalg.norm([qx, qy, qz]), qw)
            axis = np.array([qx, qy, qz]) / max(np.linalg.norm([qx, qy, qz]), 1e-300)
            poses.append(pose(angle * axis, [x, y, z]))
        return poses

    def noise(self, *sigmas):
        return np.array([self.random.gauss(0, sigma) for sigma in sigmas])


def reflectors(robot, path):
    """A laser tracker, three reflectors in each configuration, a row a configuration; some are not seen."""
    places = {"smr1": [0.04, 0, 0.03], "smr2": [-0.03, 0.05, 0.02], "smr3": [-0.02, -0.045, 0.06]}
    tracker_from_base = pose([0.02, -0.01, 2.1], [3.1, -0.6, -0.9])
    configurations = [robot.configuration() for _ in range(60)]
    header = [*JOINTS, *(f"{name}_{axis}[mm]" for name in places for axis in "xyz")]
    rows = []
    for configuration, tip in zip(configurations, robot.tips(configurations), strict=True):
        row = list(configuration)
        for place in places.values():
            seen = (tracker_from_base @ tip @ [*place, 1])[:3] * 1e3 + robot.noise(0.03, 0.03, 0.03)
            row += [f"{value:.4f}" for value in seen] if robot.random.random() > 0.05 else ["", "", ""]
        rows.append(row)
    write(path, [header, *rows])


def hand_camera(robot, path):
    """A camera in the hand and a board on the table: rvec and tvec of the board in the camera, where the camera sees it."""
    tip_from_camera = pose([0, np.pi / 2, 0], [0.05, 0.01, 0.06])
    base_from_board = pose([0, 0.02, 0.4], [0.55, 0.1, 0.05])
    rows = []
    while len(rows) < 80:
        configurations = [robot.configuration() for _ in range(2000)]
        for configuration, tip in zip(configurations, robot.tips(configurations), strict=True):
            camera_from_board = np.linalg.inv(tip @ tip_from_camera) @ base_from_board
            place = camera_from_board[:3, 3]
            distance = np.linalg.norm(place)
            # In the picture, near enough to be sharp, and the board's face not seen too flat.
            is_seen = place[2] > 0.9 * distance and -camera_from_board[:3, 2] @ place > 0.6 * distance
            if is_seen and 0.35 < distance < 0.9 and len(rows) < 80:
                place = place + robot.noise(0.0001, 0.0001, 0.0003)
                turn = rotation_vector(rotation(robot.noise(0.001, 0.001, 0.0002)) @ camera_from_board[:3, :3])
                rows.append([*configuration, *(f"{value:.7f}" for value in turn), *(f"{1e3 * value:.4f}" for value in place)])
    write(path, [[*JOINTS, "rvec_x", "rvec_y", "rvec_z", "tvec_x", "tvec_y", "tvec_z"], *rows])


def motion_capture(robot, log, take):
    """Joint readings and a rigid body of a motion capture system, each with its own clock, on the way through the configurations."""
    system_from_base = pose([-np.pi / 2, 0, 0], [0.4, 0.8, 1.1])    # y is up
    tip_from_body = pose([0.3, -0.2, 0.1], [0.02, -0.03, 0.09])
    stands = [robot.configuration() for _ in range(40)]
    time, times = 0.0, []
    for stand, following in zip(stands, [*stands[1:], stands[-1]], strict=True):
        times += [time, time + robot.random.uniform(1.4, 2.6)]
        time = times[-1] + 0.3 + max(abs(a - b) for a, b in zip(stand, following, strict=True)) / 250
    path = [stand for stand in stands for _ in range(2)]
    values = np.array(path)

    def at(moments):
        return np.stack([np.interp(moments, times, column) for column in values.T], axis=1)

    moments = np.arange(0.0, time, 0.2)
    readings = ([f"{moment:.3f}", *(f"{value:.4f}" for value in row)] for moment, row in zip(moments, at(moments), strict=True))
    write(log, [["time", *JOINTS], *readings])
    # The system was started later than the log of the joints, by this much.
    late = 3.27
    frames = np.arange(late, time, 0.2)
    head = ["Format Version", "1.21", "Take Name", "Elbow", "Export Frame Rate", "5.000000"]
    head += ["Rotation Type", "Quaternion", "Length Units", "Meters", "Coordinate Space", "Global"]
    rows = [head, [], ["", "", *["Rigid Body"] * 8], ["", "", *["Tool"] * 8], ["", "", *["0A1B2C"] * 8]]
    rows += [["", "", *["Rotation"] * 4, *["Position"] * 3, "Error Per Marker"], ["Frame", "Time", *"XYZWXYZ", ""]]
    for number, (frame, tip) in enumerate(zip(frames, robot.tips(at(frames).round(6).tolist()), strict=True)):
        body = system_from_base @ tip @ tip_from_body
        place = body[:3, 3] + robot.noise(0.0002, 0.0002, 0.0002)
        turn = quaternion(rotation(robot.noise(0.001, 0.001, 0.001)) @ body[:3, :3])
        rows.append([number, f"{frame - late:.3f}", *(f"{value:.6f}" for value in [*turn, *place]), "0.000150"])
    write(take, rows)


def in_motion(robot, log, take):
    """Joint readings and a rigid body of a motion capture system on the way from place to place without a stop, each with a clock of its own."""
    system_from_base = pose([-np.pi / 2, 0, 0], [0.4, 0.8, 1.1])    # y is up
    tip_from_body = pose([0.3, -0.2, 0.1], [0.02, -0.03, 0.09])
    span, lag, drift = 90.0, 12.3456, 25e-6
    places = [robot.configuration(0.8)]
    begins = [0.0]
    while begins[-1] < span:
        places.append([round(near + 0.4 * (far - near), 4) for near, far in zip(places[-1], robot.configuration(0.95), strict=True)])
        begins.append(begins[-1] + 1 + max(abs(a - b) for a, b in zip(places[-2], places[-1], strict=True)) / 30)
    values = np.array(places)

    def at(moments):
        index = np.clip(np.searchsorted(begins, moments, side="right") - 1, 0, len(begins) - 2)
        share = (moments - np.array(begins)[index]) / np.diff(begins)[index]
        share = (share**3 * (10 - 15 * share + 6 * share**2))[:, None]
        return values[index] + share * (values[index + 1] - values[index])

    moments = np.arange(0.0, span, 0.02)
    rows = ([f"{moment:.3f}", *(f"{value:.3f}" for value in row)] for moment, row in zip(moments, at(moments), strict=True))
    write(log, [["time", *JOINTS], *rows])
    frames = np.arange(0.05, span, 0.1)
    rows = [["time", "x[mm]", "y[mm]", "z[mm]", "qx", "qy", "qz", "qw"]]
    for frame, tip in zip(frames, robot.tips(at(frames).round(6).tolist()), strict=True):
        body = system_from_base @ tip @ tip_from_body
        place = 1e3 * body[:3, 3] + robot.noise(0.1, 0.1, 0.1)
        turn = quaternion(rotation(robot.noise(0.001, 0.001, 0.001)) @ body[:3, :3])
        stamp = frame + lag + drift * (frame - span / 2)
        rows.append([f"{stamp:.5f}", *(f"{value:.3f}" for value in place), *(f"{value:.6f}" for value in turn)])
    write(take, rows)


def hand_eye(robot, path):
    """What a controller says of its flange (X, Y, Z and KUKA's A, B, C), and where a camera on it sees a board: no joint readings."""
    flange_from_camera = pose([0, 0, 0.8], [0.04, -0.06, 0.09])
    base_from_board = pose([0.02, -0.01, 0.5], [0.6, 0.1, 0.05])
    rows = []
    while len(rows) < 25:
        turn = rotation(robot.noise(0.3, 0.3, 0.6)) @ rotation([np.pi, 0, 0])
        flange = np.eye(4)
        flange[:3, :3], flange[:3, 3] = turn, np.array([0.6, 0.1, 0.55]) + robot.noise(0.12, 0.12, 0.08)
        camera_from_board = np.linalg.inv(flange @ flange_from_camera) @ base_from_board
        if camera_from_board[2, 3] < 0.8 * np.linalg.norm(camera_from_board[:3, 3]):
            continue
        abc = np.degrees([np.arctan2(turn[1, 0], turn[0, 0]), np.arcsin(-turn[2, 0]), np.arctan2(turn[2, 1], turn[2, 2])])
        place = camera_from_board[:3, 3] + robot.noise(0.0002, 0.0002, 0.0004)
        seen = rotation_vector(rotation(robot.noise(0.001, 0.001, 0.0003)) @ camera_from_board[:3, :3])
        cells = [*(f"{1e3 * value:.3f}" for value in flange[:3, 3]), *(f"{value:.4f}" for value in abc)]
        rows.append([*cells, *(f"{value:.6f}" for value in seen), *(f"{1e3 * value:.3f}" for value in place)])
    write(path, [["X", "Y", "Z", "A", "B", "C", "rvec_x", "rvec_y", "rvec_z", "tvec_x", "tvec_y", "tvec_z"], *rows])


def corners(robot, folder):
    """A camera in the hand and a chessboard on the table: the joints of each picture, and the corners of the squares in pixels."""
    focal, centre, k1, size = 1400.0, np.array([959.5, 599.5]), -0.12, np.array([1920, 1200])
    board = [(f"corner{5 * row + column}", np.array([0.04 * column, 0.04 * row, 0, 1])) for row in range(4) for column in range(5)]
    tip_from_camera = pose([0, np.pi / 2, 0], [0.05, 0.01, 0.06])
    base_from_board = pose([0, 0.02, 0.4], [0.55, 0.1, 0.05])
    pictures, seen = [], []
    while len(pictures) < 50:
        configurations = [robot.configuration() for _ in range(2000)]
        for configuration, tip in zip(configurations, robot.tips(configurations), strict=True):
            camera_from_board = np.linalg.inv(tip @ tip_from_camera) @ base_from_board
            places = np.array([(camera_from_board @ point)[:3] for _, point in board])
            if len(pictures) == 50 or places[:, 2].min() < 0.35 or places[:, 2].max() > 0.9 or -camera_from_board[:3, 2] @ places[0] < 0.5 * places[0, 2]:
                continue
            slopes = places[:, :2] / places[:, 2:]
            pixels = focal * slopes * (1 + k1 * (slopes**2).sum(axis=1, keepdims=True)) + centre
            # Far outside, the polynomial of the lens turns back into the picture.
            if np.abs(slopes).max() > 1 or pixels.min() < 0 or (pixels > size - 1).any():
                continue
            image = f"{len(pictures) + 1:03}.png"
            pictures.append([image, *configuration])
            for (name, _), pixel in zip(board, pixels, strict=True):
                seen.append([image, name, *(f"{value:.2f}" for value in pixel + robot.noise(0.2, 0.2))])
    write(folder / "pictures.csv", [["image", *JOINTS], *pictures])
    write(folder / "corners.csv", [["image", "target", "u[px]", "v[px]"], *seen])
    write(folder / "lens.csv", [["name", "fx", "fy", "cx", "cy", "k1", "width", "height"], ["wrist", focal, focal, *centre, k1, *size]])


def touches(robot, path):
    """A pointed tool that touches the tip of a fixed pin in eight orientations: the flange's X, Y, Z and KUKA's A, B, C."""
    tip, pin = np.array([0.012, -0.003, 0.152]), np.array([0.6, 0.1, 0.05])
    rows = []
    for number in range(8):
        turn = rotation([0, 0, 0.7 * number]) @ rotation(robot.noise(0.35, 0.35, 0.0)) @ rotation([np.pi, 0, 0])
        place = pin - turn @ tip + robot.noise(0.0001, 0.0001, 0.0001)
        # One touch beside the pin.
        place = place + [0.0, 0.003, 0.0] if number == 5 else place
        abc = np.degrees([np.arctan2(turn[1, 0], turn[0, 0]), np.arcsin(-turn[2, 0]), np.arctan2(turn[2, 1], turn[2, 2])])
        rows.append([*(f"{1e3 * value:.3f}" for value in place), *(f"{value:.4f}" for value in abc)])
    write(path, [["X", "Y", "Z", "A", "B", "C"], *rows])


def tracker_and_workbook(robot, points, book):
    """A laser tracker's points as SpatialAnalyzer exports them, and the joint readings in a workbook; one point was not measured, another one twice."""
    tracker_from_base = pose([0.03, 0.01, -1.2], [2.9, 0.7, -0.8])
    configurations = [robot.configuration() for _ in range(45)]
    places = [(tracker_from_base @ tip @ [0.06, 0.01, 0.02, 1])[:3] * 1e3 for tip in robot.tips(configurations)]
    order = [number for number in range(45) if number != 12]
    order.insert(30, order[29])
    lines = ["// SpatialAnalyzer SA 2024.2.0923.4 ( x64 )", "// Points Relative to Coordinate Frame 'Cell::WORLD'", "// AXES = CARTESIAN: X,  Y,  Z (mm)"]
    for number, at in enumerate(order):
        x, y, z = places[at] + robot.noise(0.03, 0.03, 0.03)
        lines.append(f"Robot,  P{number + 1},  0,  {x:.6f},  {y:.6f},  {z:.6f},  03/17/26 10:{number // 2:02}:{number % 2 * 30:02}")
    points.write_text("\n".join(lines) + "\n", encoding="utf-8")
    rows = [["Cell 4, 17 March"], [], [f"A{number}" for number in range(1, 7)], ["°"] * 6, *configurations]
    workbook(book, "Joints", rows)


def workbook(path, sheet, rows):
    """A workbook with one sheet (.xlsx): a ZIP archive of XML, the same bytes in every run."""
    def cell(at, row, value):
        place = f"{chr(65 + at)}{row}"
        return f'<c r="{place}"><v>{value}</v></c>' if isinstance(value, float) else f'<c r="{place}" t="inlineStr"><is><t>{value}</t></is></c>'

    data = "".join(f'<row r="{row}">{"".join(cell(at, row, value) for at, value in enumerate(cells))}</row>' for row, cells in enumerate(rows, 1))
    main, office, package = (
        "http://schemas.openxmlformats.org/spreadsheetml/2006/main",
        "http://schemas.openxmlformats.org/officeDocument/2006/relationships",
        "http://schemas.openxmlformats.org/package/2006",
    )
    kind = "application/vnd.openxmlformats-officedocument.spreadsheetml"
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        f'<Override PartName="/xl/workbook.xml" ContentType="{kind}.sheet.main+xml"/><Override PartName="/xl/worksheets/sheet1.xml" ContentType="{kind}.worksheet+xml"/></Types>',
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="rId1" Type="{office}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets><sheet name="{sheet}" sheetId="1" r:id="rId1"/></sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="rId1" Type="{office}/worksheet" Target="worksheets/sheet1.xml"/></Relationships>',
        "xl/worksheets/sheet1.xml": f'<worksheet xmlns="{main}"><sheetData>{data}</sheetData></worksheet>',
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            archive.writestr(zipfile.ZipInfo(name), '<?xml version="1.0" encoding="UTF-8"?>' + text, zipfile.ZIP_DEFLATED)


def bag(robot, path):
    """A ROS 2 bag (MCAP) of a robot and a motion capture system, whose clocks differ by 0.42 s: 24 stands. Needs the package mcap."""
    try:
        from mcap.writer import CompressionType, Writer
    except ImportError:
        print(f"{path}: not written, without the package mcap")
        return
    system_from_base, tip_from_body = pose([-np.pi / 2, 0, 0], [0.4, 0.8, 1.1]), pose([0.3, -0.2, 0.1], [0.02, -0.03, 0.09])
    stands = [robot.configuration() for _ in range(24)]
    time, times = 0.0, []
    for stand, following in zip(stands, [*stands[1:], stands[-1]], strict=True):
        times += [time, time + robot.random.uniform(0.7, 1.3)]
        time = times[-1] + 0.3 + max(abs(a - b) for a, b in zip(stand, following, strict=True)) / 400
    values = np.array([stand for stand in stands for _ in range(2)])
    moments = np.arange(0.0, times[-1], 0.05)
    readings = np.stack([np.interp(moments, times, column) for column in values.T], axis=1).round(6)
    names = ["gripper", *(f"joint{number}" for number in (3, 1, 2, 6, 5, 4))]

    def header(moment, frame):
        stamp = round((1.78e9 + moment) * 1e9)
        text = frame.encode() + b"\0"
        return struct.pack("<II", stamp // 10**9, stamp % 10**9) + struct.pack("<I", len(text)) + text

    def padded(body, size):
        return body + b"\0" * (-len(body) % size)

    def joint_state(moment, row):
        body = header(moment, "")
        body = padded(body, 4) + struct.pack("<I", len(names))
        for name in names:
            text = name.encode() + b"\0"
            body = padded(body, 4) + struct.pack("<I", len(text)) + text
        order = [0.02, *(row[number - 1] for number in (3, 1, 2, 6, 5, 4))]
        body = padded(padded(body, 4) + struct.pack("<I", len(order)), 8) + struct.pack(f"<{len(order)}d", *order)
        return b"\0\1\0\0" + body + struct.pack("<II", 0, 0)

    def pose_stamped(moment, place, turn):
        return b"\0\1\0\0" + padded(header(moment, "mocap"), 8) + struct.pack("<7d", *place, *turn)

    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD, chunk_size=256 << 10)
        writer.start("ros2", library="poecal examples")
        channels = {}
        for topic, kind in [("/joint_states", "sensor_msgs/msg/JointState"), ("/vrpn_mocap/tool/pose", "geometry_msgs/msg/PoseStamped")]:
            schema = writer.register_schema(kind, "ros2msg", b"")
            channels[topic] = writer.register_channel(topic, "cdr", schema)
        for number, (moment, row, tip) in enumerate(zip(moments, readings, robot.tips(readings.tolist()), strict=True)):
            body = system_from_base @ tip @ tip_from_body
            place = body[:3, 3] + robot.noise(0.0002, 0.0002, 0.0002)
            turn = quaternion(rotation(robot.noise(0.001, 0.001, 0.001)) @ body[:3, :3])
            written = round((1.78e9 + moment) * 1e9)
            messages = [("/joint_states", joint_state(moment, np.radians(row).round(9))), ("/vrpn_mocap/tool/pose", pose_stamped(moment + 0.42, place.round(7), turn.round(7)))]
            for topic, data in messages:
                writer.add_message(channels[topic], written + 4_000_000, data, written, sequence=number)
        writer.finish()


def iso9283(path):
    """A test of ISO 9283: five poses of a cube of 0.6 m, 30 cycles, a tracker that stands anywhere."""
    rng = np.random.default_rng(9283)
    commanded = np.array([[0, 0, 0], [1, 1, 1], [-1, 1, 1], [-1, -1, -1], [1, -1, -1]]) * 0.24 + [0.9, 0, 0.6]
    errors = np.array([[0.18, -0.22, 0.31], [0.42, 0.1, -0.2], [-0.3, 0.25, 0.1], [0.05, -0.4, 0.35], [-0.15, 0.2, -0.45]]) * 1e-3
    device_from_base = rotation(np.array([0, 0, 0.7])) @ rotation(np.array([0, 0.02, 0]))
    rows = ["pose,cycle,commanded_x[mm],commanded_y[mm],commanded_z[mm],x[mm],y[mm],z[mm],speed".split(",")]
    for cycle in range(30):
        for pose in (4, 3, 2, 1, 0):
            reached = commanded[pose] + errors[pose] + rng.normal(size=3) * [2e-5, 1.2e-5, 1.5e-5]
            seen = device_from_base @ reached + [2.1, -1.4, 0.3] + rng.normal(size=3) * 1e-5
            cells = [f"{1e3 * value:.3f}" for value in commanded[pose]] + [f"{1e3 * value:.4f}" for value in seen]
            rows.append([f"P{pose + 1}", cycle + 1, *cells, "100 %"])
    write(path, rows)


def write(path, rows):
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def main(poecal, folder):
    folder = Path(folder)
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        robot = Simulated(poecal, scratch)
        reflectors(robot, folder / "reflectors.csv")
        hand_camera(robot, folder / "camera.csv")
        motion_capture(robot, folder / "joints.csv", folder / "take.csv")
        hand_eye(robot, folder / "hand_eye.csv")
        corners(robot, folder)
        touches(robot, folder / "touches.csv")
        tracker_and_workbook(robot, folder / "points.txt", folder / "joints.xlsx")
        iso9283(folder / "iso9283.csv")
        bag(robot, folder / "session.mcap")
        in_motion(robot, folder / "moving_joints.csv", folder / "moving_take.csv")


if __name__ == "__main__":
    main(*sys.argv[1:])
