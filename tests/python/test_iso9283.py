"""`poecal iso9283` beside formulas of ISO 9283:1998 that are written out with NumPy, and its answers to wrong rows."""

import json
import math
import subprocess
from pathlib import Path

import numpy as np
import pytest
from program import ROOT, program

RECORDED = ROOT / "examples/howto/iso9283.csv"


def run(*arguments) -> subprocess.CompletedProcess:
    return subprocess.run([program(), "iso9283", *map(str, arguments)], capture_output=True, text=True)


def figures(*arguments) -> dict:
    ended = run(*arguments, "--json")
    assert ended.returncode == 0, ended.stderr
    found = json.loads(ended.stdout)
    return {(it["figure"], it["pose"]): it for it in found["figures"]}


def table(folder: Path, rows: list[list[str]], header: str) -> Path:
    path = folder / "rows.csv"
    path.write_text("\n".join([header, *(",".join(row) for row in rows)]) + "\n")
    return path


def recorded() -> tuple[str, list[list[str]]]:
    header, *rows = RECORDED.read_text().splitlines()
    return header, [row.split(",") for row in rows]


def fitted(measured: np.ndarray, commanded: np.ndarray) -> np.ndarray:
    """Measured points turned and shifted onto commanded ones (least squares, by singular values)."""
    a, b = measured - measured.mean(0), commanded - commanded.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    turn = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return a @ turn + commanded.mean(0)


def test_figures_are_those_of_the_standard():
    _, rows = recorded()
    names = sorted({row[0] for row in rows})
    numbers = {name: np.array([[float(cell) for cell in row[2:8]] for row in rows if row[0] == name]) for name in names}
    commanded = np.array([numbers[name][0, :3] for name in names])
    measured = np.array([numbers[name][:, 3:] for name in names])
    centre = measured.mean(1)
    accuracy = np.linalg.norm(fitted(centre, commanded) - commanded, axis=1)
    lengths = np.linalg.norm(measured - centre[:, None], axis=2)
    repeatability = lengths.mean(1) + 3 * lengths.std(1, ddof=1)
    distance = np.linalg.norm(measured[1] - measured[3], axis=1)
    found = figures(RECORDED)
    for k, name in enumerate(names):
        assert found["AP", name]["found"] == pytest.approx(accuracy[k], abs=1e-9)
        assert found["RP", name]["found"] == pytest.approx(repeatability[k], abs=1e-9)
    own = found["AD", "P2-P4"]["found"]
    assert own == pytest.approx(distance.mean() - np.linalg.norm(commanded[1] - commanded[3]), abs=1e-9)
    spread = found["RD", "P2-P4"]
    assert spread["found"] == pytest.approx(3 * distance.std(ddof=1), abs=1e-9)
    # χ² of 29 degrees of freedom: 16.0471 and 45.7223 as tables have them.
    for end, square in [("from", 45.7223), ("to", 16.0471)]:
        assert spread[end] == pytest.approx(spread["found"] * math.sqrt(29 / square), rel=1e-5)


def test_angles_and_variations(tmp_path):
    rng = np.random.default_rng(1)
    lines, turns = [], {}
    for cycle in range(30):
        for k, place in enumerate([(0, 0, 0), (300, 0, 100), (0, 300, 0)]):
            for approach, shift in [("a", 0.0), ("b", 0.03)]:
                spot = np.array(place) + rng.normal(size=3) * 0.01 + [shift, 0, 0]
                turn = np.array([1e-3, -2e-3, 5e-4]) * k + rng.normal(size=3) * 1e-4
                angle = np.linalg.norm(turn)
                quaternion = [*(turn / angle * math.sin(angle / 2)), math.cos(angle / 2)]
                if approach == "a":
                    turns.setdefault(f"P{k + 1}", []).append(turn)
                cells = [f"P{k + 1}", cycle, approach, *place, 0, 0, 0, *spot, *quaternion]
                lines.append([str(cell) for cell in cells])
    header = "pose,cycle,approach,commanded_x[mm],commanded_y[mm],commanded_z[mm],commanded_roll[deg],commanded_pitch[deg],commanded_yaw[deg],"
    found = figures(table(tmp_path, lines, header + "x[mm],y[mm],z[mm],qx,qy,qz,qw"), "--device-frame", "base")
    for name, own in turns.items():
        for axis, letter in enumerate("abc"):
            angles = np.degrees(np.array(own)[:, axis])
            assert found["AP" + letter, name]["found"] == pytest.approx(angles.mean(), abs=1e-9)
            assert found["RP" + letter, name]["found"] == pytest.approx(3 * angles.std(ddof=1), abs=1e-9)
        assert 0.015 < found["vAP", name]["found"] < 0.045 and found["vAP", name]["from"] > 0


def test_wrong_rows_are_refused_in_a_sentence(tmp_path):
    header, rows = recorded()

    def refused(change) -> str:
        changed = [list(row) for row in rows]
        change(changed)
        ended = run(table(tmp_path, changed, header))
        assert ended.returncode == 2 and ended.stdout == "", ended
        errors = [line for line in ended.stderr.splitlines() if line.startswith("error: ")]
        assert len(errors) == 1, ended.stderr
        return errors[0]

    def exchanged(it):
        it[0][5:8], it[1][5:8] = it[1][5:8], it[0][5:8]

    def two_speeds(it):
        it[7][8] = "50 %"

    def doubled(it):
        it.append(list(it[0]))

    assert "rows.csv:3: found the position of pose P5" in refused(exchanged) or "exchange it with" in refused(exchanged)
    assert "rows.csv:9: found the speed `50 %` beside `100 %`" in refused(two_speeds)
    assert "rows.csv:152: found pose P5 in cycle 1 a second time" in refused(doubled)
    assert "found 2 cycles of pose" in refused(lambda it: it.__delitem__(slice(10, None)))
    lacking = run(table(tmp_path, rows[:44] + rows[45:], header))
    assert lacking.returncode == 0 and "found no row of pose P1 in cycle 9" in lacking.stderr, lacking.stderr
    few = run(table(tmp_path, rows[:50], header))
    assert few.returncode == 0 and "found 10 cycles, expected 30 for a test of ISO 9283" in few.stderr, few.stderr


def test_limits_decide():
    for limit, code in [("AP:0.8mm", 0), ("AP:0.56mm", 1), ("AP:0.4mm,RP:0.2mm", 1), ("vAP:1mm", 2), ("ap:1", 2)]:
        assert run(RECORDED, "--accept", limit).returncode == code, limit


def test_result_does_not_depend_on_threads():
    one, four = (run(RECORDED, "--json", "--threads", count).stdout for count in (1, 4))
    strip = [json.loads(text)["figures"] for text in (one, four)]
    assert strip[0] == strip[1]


def test_a_planned_test_is_measured(tmp_path):
    model = ROOT / "examples/elbow/robot.urdf"
    listed, path = tmp_path / "test.csv", tmp_path / "test.src"
    command = [program(), "plan", str(model), "--purpose", "iso9283", "--out", str(listed), "--program", str(path)]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == 0 and "P5, P4, P3, P2, P1" in ended.stdout, ended.stderr
    assert path.read_text().count("PTP {") == 150
    header, *rows = listed.read_text().splitlines()
    assert header.endswith("x[mm],y[mm],z[mm]") and len(rows) == 150
    joints = tmp_path / "joints.csv"
    joints.write_text("\n".join(line.rsplit(",", 3)[0].split(",", 2)[2] for line in [header, *rows]) + "\n")
    poses = subprocess.run([program(), "predict", str(model), str(joints)], capture_output=True, text=True).stdout.splitlines()[1:]
    rng = np.random.default_rng(2)
    filled = []
    for row, pose in zip(rows, poses, strict=True):
        place = 1e3 * np.array([float(cell) for cell in pose.split(",")[:3]]) + rng.normal(size=3) * 0.01
        filled.append(row.removesuffix(",,,").split(",") + [f"{cell:.6f}" for cell in place])
    found = figures(table(tmp_path, filled, header), "--robot", model)
    assert len([key for key in found if key[0] == "AP"]) == 5
    assert all(it["found"] < 0.02 for key, it in found.items() if key[0] == "AP")
    plane = subprocess.run([*command[:5], "--workspace", "700,-150,500:900,150,500mm", "--count", "2", "--json"], capture_output=True, text=True)
    assert plane.returncode == 0, plane.stderr
    told = json.loads(plane.stdout[: plane.stdout.rindex("}") + 1])
    assert told["sides_mm"] == pytest.approx([200, 300, 0]) and told["cycles"] == 2
    assert [pose["position_mm"] for pose in told["poses"]][1] == pytest.approx([880, 120, 500])
    box = subprocess.run([*command[:5], "--workspace", "700,-150,400:900,150,500mm"], capture_output=True, text=True)
    assert box.returncode == 2 and "or a plane, of which one is zero" in box.stderr, box.stderr
    far = subprocess.run([*command[:5], "--workspace", "2000,0,0:3000,1000,1000mm"], capture_output=True, text=True)
    assert far.returncode == 2 and "out of reach or beyond limits" in far.stderr, far.stderr


def moved(rows: list[list[str]], share: float) -> list[list[str]]:
    """The same test with the errors of positions reduced to a share, in the device frame that fits the commands best."""
    commanded, measured = (np.array([[float(cell) for cell in row[at : at + 3]] for row in rows]) for at in (2, 5))
    a, b = commanded - commanded.mean(0), measured - measured.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    ideal = a @ (u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v) + measured.mean(0)
    reduced = ideal + share * (measured - ideal)
    return [[*row[:5], *(f"{cell:.4f}" for cell in it), *row[8:]] for row, it in zip(rows, reduced, strict=True)]


def test_a_test_before_stands_beside(tmp_path):
    header, rows = recorded()
    after = table(tmp_path, moved(rows, 0.25), header)
    found, before = figures(after, "--reference", RECORDED), figures(RECORDED)
    assert {key for key in found if "before" in found[key]} == set(found) == set(before)
    for key, it in found.items():
        assert it["before"]["found"] == before[key]["found"]
    assert found["AP", "P3"]["found"] == pytest.approx(0.25 * before["AP", "P3"]["found"], rel=0.02)
    told = run(after, "--reference", RECORDED).stdout
    assert "before, mm" in told and "beside" in told
    other = [list(row) for row in rows]
    for row in other:
        row[2] = f"{float(row[2]) + 5:.3f}"
    ended = run(table(tmp_path, other, header), "--reference", RECORDED)
    assert ended.returncode == 2 and "commanded 5.000 mm from its command in the rows of --reference" in ended.stderr, ended.stderr
    assert run(RECORDED, "--reference", RECORDED).returncode == 2


def test_pages_have_figures_pictures_and_record(tmp_path):
    header, rows = recorded()
    after = table(tmp_path, moved(rows, 0.25), header)
    stated = ["--record", "robot=Elbow <6>", "--record", "warm_up=1 h", "--sigma-position", "0.01mm", "--accept", "AP:0.2mm"]
    report, certificate = tmp_path / "report.html", tmp_path / "certificate.html"
    for page, words in [(report, []), (certificate, ["--certificate"])]:
        ended = run(after, "--reference", RECORDED, *stated, "--report", page, *words)
        assert ended.returncode == 0, ended.stderr
        text = page.read_text()
        assert "Elbow &lt;6&gt;" in text and "1 h" in text and "100 %" in text and "PASS" in text and "<script" not in text
        found = json.loads(run(after, "--reference", RECORDED, *stated, "--json").stdout)
        largest = max((it for it in found["figures"] if it["figure"] == "AP"), key=lambda it: it["found"])
        assert f"{largest['found']:.4f}" in text and f"{largest['before']['found']:.4f}" in text
    drawn = [page.read_text().count("<svg") for page in (report, certificate)]
    # The cube from two sides, on the certificate and in the report; each of five poses from two sides.
    assert drawn == [2 + 2 + 10, 2]
    assert report.read_text().count("<dt>Warm-up</dt>") == 2
    ended = run(RECORDED, "--report", report)
    assert ended.returncode == 2 and "report.html" in ended.stderr, ended.stderr
    assert run(RECORDED, "--certificate").returncode == 2
    ended = run(RECORDED, "--record", "speed=50 %", "--report", tmp_path / "none.html")
    assert ended.returncode == 2 and "found the speed `100 %` and `50 %` in the record" in ended.stderr, ended.stderr
    assert not (tmp_path / "none.html").exists()


def test_corners_in_pictures_are_poses(tmp_path):
    """Five of the pictures, each taken twelve times; their camera and board are those of the calibration."""
    folder = ROOT / "examples/howto"
    model = ROOT / "examples/elbow/robot.urdf"
    pictures, corners = folder / "pictures.csv", folder / "corners.csv"
    known = ["--camera", folder / "lens.csv", "--markers", "chessboard:6x5:40mm"]
    made = [program(), "calibrate", model, pictures, corners, *known, "--out", tmp_path / "calibrated"]
    ended = subprocess.run([str(word) for word in made], capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    header, *poses = pictures.read_text().splitlines()
    seen: dict[str, list[list[str]]] = {}
    for line in corners.read_text().splitlines()[1:]:
        seen.setdefault(line.split(",")[0], []).append(line.split(","))
    rng = np.random.default_rng(3)
    listed, taken = [f"pose,cycle,{header}"], ["image,target,u[px],v[px]"]
    for cycle in range(12):
        for k, line in enumerate(poses[:5]):
            image, joints = line.split(",", 1)
            listed.append(f"P{k + 1},{cycle + 1},{cycle}-{k}.png,{joints}")
            for _, name, u, v in seen[image]:
                du, dv = rng.normal(size=2) * 0.02
                taken.append(f"{cycle}-{k}.png,{name},{float(u) + du:.3f},{float(v) + dv:.3f}")
    rows, points = tmp_path / "poses.csv", tmp_path / "seen.csv"
    rows.write_text("\n".join(listed) + "\n")
    points.write_text("\n".join(taken) + "\n")
    calibration = tmp_path / "calibrated/calibration.json"
    found = figures(rows, points, "--robot", calibration)
    assert found == figures(points, rows, "--robot", calibration)
    ap = [it for (figure, _), it in found.items() if figure == "AP"]
    assert len(ap) == 5 and all(it["cycles"] == 12 and it["corrected"]["found"] < 3 for it in ap)
    assert max(it["found"] for it in ap) > 2 * max(it["corrected"]["found"] for it in ap)
    rows.write_text("\n".join(listed).replace("P1,3,2-0.png", "P1,3,2-x.png").replace("P2,3,2-1.png", "P2,3,2-0.png").replace("2-x.png", "2-1.png") + "\n")
    assert run(rows, points, "--robot", calibration).returncode == 2
    alone = run(rows, points, "--robot", model)
    assert alone.returncode == 2 and "no camera, expected --camera FILE" in alone.stderr, alone.stderr
