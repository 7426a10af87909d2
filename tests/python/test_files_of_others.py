"""Files as independent packages write them: cameras of OpenCV, samples of hand-eye programs, workbooks, bags, joint states.

Values that poecal reads are equal to 1e-9 to those that were written, or the refusal names the kind and the remedy. Packages that are not installed
are skipped, and counted.
"""

import csv
import io
import json
import math
import subprocess
from pathlib import Path

import numpy as np
import pytest
import yaml
from program import ROOT, program
from scipy.spatial.transform import Rotation

ELBOW = ROOT / "examples/elbow"
MATRIX = np.array([[1400.0, 0, 959.5], [0, 1400.25, 599.25], [0, 0, 1]])
BENT = np.array([[-0.12, 0.001, 1e-5, -2e-5, 0.0]])
JOINTS = [f"joint{k}" for k in range(1, 7)]
CORNERS = ["--markers", "chessboard:6x5:40mm"]


def run(folder: Path, *words: object, code: int = 0) -> str:
    """All that a run printed."""
    done = subprocess.run([program(), *map(str, words)], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def told(folder: Path, *words: object) -> dict:
    """JSON output of a run."""
    done = subprocess.run([program(), *map(str, words), "--json"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


# Cameras.


def lens_of(folder: Path, camera: Path) -> dict:
    """The lens as stored by a calibration that read the file."""
    howto = ROOT / "examples/howto"
    files = [ELBOW / "robot.urdf", howto / "pictures.csv", howto / "corners.csv"]
    out = folder / f"{camera.name}.out"
    run(folder, "calibrate", *files, "--camera", camera, *CORNERS, "--fix", "joints", "--out", out, "--quiet")
    return json.loads((out / "calibration.json").read_text())["pictures"]["cameras"][0]


def written_by_opencv(folder: Path) -> list[Path]:
    cv2 = pytest.importorskip("cv2")
    found = []
    for ending in ("yaml", "xml", "json"):
        path = folder / f"opencv_{cv2.__version__.split('.')[0]}.{ending}"
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        storage.write("image_width", 1920)
        storage.write("image_height", 1200)
        storage.write("camera_matrix", MATRIX)
        storage.write("distortion_coefficients", BENT)
        storage.release()
        found.append(path)
    return found


def written_by_scripts(folder: Path) -> list[Path]:
    found = [folder / name for name in ("lists.yaml", "lists.json", "realsense.json", "oak.json")]
    lists = {"camera_matrix": MATRIX.tolist(), "dist_coeff": BENT.tolist()}
    found[0].write_text(yaml.dump(lists))
    found[1].write_text(json.dumps(lists))
    [fx, fy, cx, cy] = [MATRIX[0, 0], MATRIX[1, 1], MATRIX[0, 2], MATRIX[1, 2]]
    size = {"width": 1920, "height": 1200}
    color = {**size, "ppx": cx, "ppy": cy, "fx": fx, "fy": fy, "model": "distortion.brown_conrady", "coeffs": BENT[0].tolist()}
    found[2].write_text(json.dumps({"color": color}))
    oak = {**size, "cameraType": 0, "intrinsicMatrix": MATRIX.tolist(), "distortionCoeff": BENT[0].tolist() + [0.0] * 9}
    found[3].write_text(json.dumps({"boardName": "OAK-D", "cameraData": [[2, oak]]}, indent=2))
    return found


def test_cameras_are_the_lens_that_was_written(tmp_path):
    files = written_by_scripts(tmp_path) + written_by_opencv(tmp_path)
    for path in files:
        found = lens_of(tmp_path, path)
        assert np.allclose(found["focal_px"], [MATRIX[0, 0], MATRIX[1, 1]], rtol=1e-9), path.name
        assert np.allclose(found["centre_px"], MATRIX[:2, 2], rtol=1e-9), path.name
        assert np.allclose(found["distortion"][:5], BENT[0], rtol=1e-9), path.name
    print(f"{len(files)} files of cameras")


# Samples of hand-eye programs.


def poses() -> list[tuple[np.ndarray, np.ndarray]]:
    """Poses of the flange and of a board that a camera in the hand sees, without noise."""
    draw = np.random.default_rng(5)

    def pose(place, turn):
        found = np.eye(4)
        found[:3, 3], found[:3, :3] = place, Rotation.from_euler("xyz", turn, degrees=True).as_matrix()
        return found

    camera, board = pose([0.04, -0.06, 0.09], [2, -3, 40]), pose([0.6, 0.1, 0.02], [1, 2, 30])
    found = []
    for _ in range(15):
        seen = pose([*draw.uniform(-0.05, 0.05, 2), draw.uniform(0.35, 0.5)], [180 + draw.uniform(-30, 30), *draw.uniform(-30, 30, 2)])
        found.append((board @ np.linalg.inv(seen) @ np.linalg.inv(camera), seen))
    return found


def samples(folder: Path) -> dict[str, list[Path]]:
    all_poses = poses()

    def transform(it):
        x, y, z, w = Rotation.from_matrix(it[:3, :3]).as_quat().tolist()
        at = dict(zip("xyz", it[:3, 3].tolist(), strict=True))
        return {"rotation": {"x": x, "y": y, "z": z, "w": w}, "translation": at}

    def rvec(it):
        return [*Rotation.from_matrix(it[:3, :3]).as_rotvec(), *it[:3, 3]]

    moveit = [{"effector_wrt_world": a.ravel().tolist(), "object_wrt_sensor": b.ravel().tolist()} for a, b in all_poses]
    easy = {"samples": [{"robot": transform(a), "tracking": transform(b)} for a, b in all_poses]}
    script = {"robot_poses": [a.tolist() for a, _ in all_poses], "camera_poses": [b.tolist() for _, b in all_poses]}
    for name, content in (("moveit.yaml", moveit), ("easy.yaml", easy)):
        (folder / name).write_text(yaml.dump(content))
    (folder / "script.json").write_text(json.dumps(script))
    seen = "rvec_x,rvec_y,rvec_z,tvec_x,tvec_y,tvec_z".split(",")
    for name, stem, order in (("franka.csv", "O_T_EE[{}]", "F"), ("sixteen.csv", "T{}", "C")):
        with open(folder / name, "w", newline="") as out:
            rows = csv.writer(out)
            rows.writerow([stem.format(k) for k in range(16)] + seen)
            rows.writerows([*a.ravel(order=order), *rvec(b)] for a, b in all_poses)
    for name in ("visp", "zivid", "targets"):
        (folder / name).mkdir()
    for k, (a, b) in enumerate(all_poses, 1):
        for whose, it in (("rPe", a), ("cPo", b)):
            vector = [*it[:3, 3], *Rotation.from_matrix(it[:3, :3]).as_rotvec()]
            text = "rows: 6\ncols: 1\ndata:\n" + "".join(f"  - [{float(value)!r}]\n" for value in vector)
            (folder / f"visp/pose_{whose}_{k}.yaml").write_text(text)
        scaled = a.copy()
        scaled[:3, 3] *= 1e3
        matrix = {"__version__": {"serializer": 1, "data": 1}, "FloatMatrix": {"Data": scaled.tolist()}}
        (folder / f"zivid/pos{k:02}.yaml").write_text(yaml.dump(matrix))
        np.savetxt(folder / f"targets/target_{k}.txt", b, fmt="%.17g")
    names = ["moveit.yaml", "easy.yaml", "script.json", "franka.csv", "sixteen.csv", "visp"]
    return {name: [folder / name] for name in names} | {"zivid": [folder / "zivid", folder / "targets"]}


def test_samples_give_the_camera_that_made_them(tmp_path):
    for name, paths in samples(tmp_path).items():
        frame = told(tmp_path, "hand-eye", *paths, "--camera", "in-hand")["camera_frame"]
        assert np.allclose(frame["position_m"], [0.04, -0.06, 0.09], atol=1e-9), name
        turn = Rotation.from_quat(frame["quaternion_xyzw"]) * Rotation.from_euler("xyz", [2, -3, 40], degrees=True).inv()
        assert turn.magnitude() < 1e-9, name


# Joint lists.


def session() -> tuple[list[list[str]], list[list[str]]]:
    """Readings (deg) and points (mm) of the elbow's example, as they are written there."""
    lines = [line for line in (ELBOW / "points.csv").read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))[:24]
    joints = [name for name in rows[0] if name.startswith("joint")]
    places = [name for name in rows[0] if name[0] in "xyz"]
    return [[row[name] for name in joints] for row in rows], [[row[name] for name in places] for row in rows]


def imported(folder: Path, *files: Path) -> np.ndarray:
    """The table that poecal makes of files: joints (deg) and points (mm)."""
    run(folder, "import", ELBOW / "robot.urdf", *files, "--join", "rows", "--units", "mm,deg", "--out", "session.csv", "--force", "--quiet")
    rows = list(csv.DictReader((folder / "session.csv").open()))
    names = [name for name in rows[0] if name.split("[")[0] in [*JOINTS, "x", "y", "z"]]
    return np.array([[float(row[name]) for name in names] for row in rows])


def lists(folder: Path) -> dict[str, Path]:
    readings, _ = session()
    found = {}
    registers = "[*POSREG*]$POSREG  Storage: CMOS  Access: RW  : ARRAY[1,100] OF Position Reg\n"
    for k, (a, b, c, d, e, f) in enumerate(readings, 1):
        registers += f"   [1,{k}] =   'P{k}'\n  Group: 1\n  J1 = {a} deg   J2 = {b} deg   J3 = {c} deg \n  J4 = {d} deg   J5 = {e} deg   J6 = {f} deg \n"
    values = "".join(
        f'<Value key="{k}" ' + " ".join(f'j{at}="{value}"' for at, value in enumerate(row, 1)) + " />\n" for k, row in enumerate(readings)
    )
    data = f'<?xml version="1.0" encoding="utf-8" ?>\n<Database xmlns="http://www.staubli.com/robotics/VAL3/Data/2">\n<Datas>\n<Data name="jMeas" \
access="public" type="jointRx" size="{len(readings)}">\n{values}</Data>\n</Datas>\n</Database>\n'
    echo = io.StringIO()
    for k, row in enumerate(readings):
        turns = [repr(math.radians(float(value))) for value in row]
        csv.writer(echo).writerow([17 + k, 5, "", *reversed(JOINTS), *reversed(turns), *["0.0"] * 6])
    letters = "S[deg],L[deg],U[deg],R[deg],B[deg],T[deg]\n" + "".join(",".join(row) + "\n" for row in readings)
    for name, text in (("posreg.va", registers), ("app.dtx", data), ("echo.csv", echo.getvalue()), ("letters.csv", letters)):
        found[name] = folder / name
        found[name].write_text(text, encoding="utf-8")
    return found


def test_joint_lists_are_the_readings_that_were_written(tmp_path):
    readings, places = session()
    points = tmp_path / "points.csv"
    points.write_text("x[mm],y[mm],z[mm]\n" + "".join(",".join(row) + "\n" for row in places))
    expected = np.array([[float(value) for value in [*row, *place]] for row, place in zip(readings, places, strict=True)])
    for name, path in lists(tmp_path).items():
        assert np.allclose(imported(tmp_path, path, points), expected, rtol=0, atol=1e-9), name


def test_workbooks_with_two_rows_of_names(tmp_path):
    readings, places = session()
    expected = np.array([[float(value) for value in [*row, *place]] for row, place in zip(readings, places, strict=True)])
    openpyxl, xlsxwriter = pytest.importorskip("openpyxl"), pytest.importorskip("xlsxwriter")
    merged = openpyxl.Workbook()
    sheet = merged.active
    sheet.append(["Pose", "Joint angles (deg)", *[None] * 5, "Measured (mm)", None, None])
    sheet.append([None, 1, 2, 3, 4, 5, 6, "X", "Y", "Z"])
    for cells in ("A1:A2", "B1:G1", "H1:J1"):
        sheet.merge_cells(cells)
    for k, row in enumerate(expected, 1):
        sheet.append([k, *row.tolist()])
    merged.save(tmp_path / "merged.xlsx")
    sets = xlsxwriter.Workbook(tmp_path / "sets.xlsx")
    sheet = sets.add_worksheet("Messung")
    sheet.write_row(0, 0, ["Pose", *[f"Joint {k}" for k in range(1, 7)]])
    for at, word in ((7, "Commanded"), (10, "Measured"), (13, "Difference")):
        sheet.merge_range(0, at, 0, at + 2, word)
    sheet.write_row(1, 1, ["deg"] * 6 + ["X (mm)", "Y (mm)", "Z (mm)"] * 3)
    for k, row in enumerate(expected):
        wanted = row[6:] + 2 * np.sin([k, 2 * k, 3 * k])
        sheet.write_row(2 + k, 0, [k + 1, *row[:6], *wanted, *row[6:], *(row[6:] - wanted)])
    sheet.write_row(2 + len(expected), 0, ["Average"])
    sheet.write_row(2 + len(expected), 13, [-1.5, 0.7, -0.4])
    sets.close()
    for name in ("merged.xlsx", "sets.xlsx"):
        found = imported(tmp_path, tmp_path / name)
        assert np.allclose(found, expected, rtol=0, atol=1e-9), name


def test_durations_of_ods_are_seconds(tmp_path):
    pytest.importorskip("odf")
    from odf.opendocument import OpenDocumentSpreadsheet
    from odf.table import Table, TableCell, TableRow
    from odf.text import P

    readings, places = session()
    book = OpenDocumentSpreadsheet()
    table = Table(name="Log")

    def row(cells):
        line = TableRow()
        for cell in cells:
            line.addElement(cell)
        table.addElement(line)

    def text(it):
        cell = TableCell(valuetype="string")
        cell.addElement(P(text=it))
        return cell

    names = ["time", *[f"{name}[deg]" for name in JOINTS], "x[mm]", "y[mm]", "z[mm]"]
    row([text(name) for name in names])
    for k, numbers in enumerate(zip(readings, places, strict=True)):
        time = TableCell(valuetype="time", timevalue=f"PT00H{k // 6:02}M{10 * (k % 6):02}.5S")
        row([time, *[TableCell(valuetype="float", value=float(value)) for part in numbers for value in part]])
    book.spreadsheet.addElement(table)
    path = tmp_path / "log.ods"
    book.save(path)
    said = run(tmp_path, "check", ELBOW / "robot.urdf", path)
    assert "time" not in [line for line in said.splitlines() if "ignored" in line]
    run(tmp_path, "import", ELBOW / "robot.urdf", path, "--out", "timed.csv", "--quiet")


# Bags.


@pytest.mark.parametrize("mode", ["message", "file"])
def test_bags_that_rosbags_compressed(tmp_path, mode):
    pytest.importorskip("rosbags")
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    header, stamp = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]
    readings, places = session()
    bag = tmp_path / "bag"
    writer = Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.MESSAGE if mode == "message" else CompressionMode.FILE, CompressionFormat.ZSTD)
    with writer:
        joints = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        seen = writer.add_connection("/point", "geometry_msgs/msg/PointStamped", typestore=store)
        at = 0
        for row, place in zip(readings, places, strict=True):
            for _ in range(20):
                own = header(stamp=stamp(sec=100 + at // 20, nanosec=at % 20 * 50_000_000), frame_id="base")
                turns, none = np.radians([float(value) for value in row]), np.array([])
                state = types["sensor_msgs/msg/JointState"](header=own, name=JOINTS, position=turns, velocity=none, effort=none)
                point = types["geometry_msgs/msg/Point"](*[1e-3 * float(value) for value in place])
                pointed = types["geometry_msgs/msg/PointStamped"](header=own, point=point)
                time = (100 + at // 20) * 10**9 + at % 20 * 50_000_000
                writer.write(joints, time, store.serialize_cdr(state, state.__msgtype__))
                writer.write(seen, time, store.serialize_cdr(pointed, pointed.__msgtype__))
                at += 1
    said = run(tmp_path, "check", ELBOW / "robot.urdf", bag)
    assert f"sensor_msgs/msg/JointState, {at} messages" in said, said


# Kinds that are not read.


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("take.c3d", b"\x02\x50" + bytes(510), ["C3D", "ezc3d"]),
        ("take.bin", b"\x02\x50" + bytes(510), ["C3D", "export its trajectories"]),
        ("markers.trc", b"PathFileType\t4\t(X/Y/Z)\tmarkers.trc\nDataRate\tCameraRate\n100\t100\n", ["TRC", "export them as CSV"]),
        ("survey.gsi", b"*110001+00000000000000P1 81..00+0000000001234567\n", ["GSI", "text with a header"]),
        ("points.xml", b'<?xml version="1.0"?>\n<LandXML version="1.2">\n</LandXML>\n', ["LandXML", "text with a header"]),
    ],
)
def test_other_kinds_are_named_with_what_to_do(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    said = run(tmp_path, "check", ELBOW / "robot.urdf", name, code=2)
    assert all(word in said for word in words), said
