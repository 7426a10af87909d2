"""Files that command lines of corpus_lines.py read: of this work tree, changed ones, tables, programs and pictures. None is random."""

import base64
import csv
import io
import math
import shutil
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SEEDS = ROOT / "fuzz/seeds"

Rows = list[list[str]]

# Arms of makers of controllers: for each axis a point on it and its direction, then the pose of the flange at zero (mm, degrees), and limits.
ARMS: dict[str, tuple[list[tuple[list[float], list[int]]], list[float], list[int], list[list[int]]]] = {
    "kuka": (
        [([0, 0, 0], [0, 0, -1]), ([25, 0, 400], [0, 1, 0]), ([585, 0, 400], [0, 1, 0]),
         ([585, 0, 425], [-1, 0, 0]), ([1100, 0, 425], [0, 1, 0]), ([1100, 0, 425], [-1, 0, 0])],
        [1190, 0, 425], [0, 90, 0], [[-170, 170], [-190, 45], [-120, 156], [-185, 185], [-120, 120], [-350, 350]],
    ),
    "ur": (
        [([0, 0, 0], [0, 0, 1]), ([0, 0, 89.2], [0, -1, 0]), ([-425, 0, 89.2], [0, -1, 0]),
         ([-817, 0, 89.2], [0, -1, 0]), ([-817, -109.2, 0], [0, 0, -1]), ([-817, 0, -5.5], [0, -1, 0])],
        [-817, -191.5, -5.5], [90, 0, 0], [[-360, 360]] * 6,
    ),
    "fanuc": (
        [([0, 0, 0], [0, 0, 1]), ([50, 0, 0], [0, 1, 0]), ([50, 0, 330], [0, -1, 0]),
         ([50, 0, 365], [-1, 0, 0]), ([385, 0, 365], [0, -1, 0]), ([385, 0, 365], [-1, 0, 0])],
        [465, 0, 365], [180, -90, 0], [[-170, 170], [-100, 145], [-140, 213], [-190, 190], [-125, 125], [-360, 360]],
    ),
    "abb": (
        [([0, 0, 0], [0, 0, 1]), ([320, 0, 780], [0, 1, 0]), ([320, 0, 1860], [0, 1, 0]),
         ([320, 0, 2060], [1, 0, 0]), ([1462, 0, 2060], [0, 1, 0]), ([1462, 0, 2060], [1, 0, 0])],
        [1662, 0, 2060], [0, 90, 0], [[-170, 170], [-65, 85], [-180, 70], [-300, 300], [-130, 130], [-360, 360]],
    ),
}  # fmt: skip

TEXTS = {
    "camera.toml": """pose = "target_from_device"
target_name = "camera"

[position]
columns = ["tvec_x", "tvec_y", "tvec_z"]
unit = "mm"

[orientation]
form = "rotation_vector"
columns = ["rvec_x", "rvec_y", "rvec_z"]
unit = "rad"
""",
    "reflectors.toml": "\n".join(
        f'[[targets]]\nname = "{name}"\nposition = {{ columns = ["{name}_x", "{name}_y", "{name}_z"] }}\n' for name in ("smr1", "smr2", "smr3")
    ),
    "coupled.toml": '[joints]\njoint3 = { columns = { "joint2[deg]" = -1, "joint3[deg]" = 1 }, unit = "deg" }\n',
    "wrong.toml": '[joints]\njoint1 = "shoulder"\njoint9 = "A9"\n',
    "broken.toml": "[joints\n",
    "poecal.toml": """poecal_settings = 1
model = "robot.urdf"
measurements = ["points.csv"]
sigma_position = "0.05mm"
held_out = 0.25
seed = 4
train_where = "no=column"
out = "by-settings"

[record]
serial = "4711"
robot = "Maker Type 6"
""",
    "good.toml": 'poecal_settings = 1\nmodel = "robot.urdf"\nmeasurements = ["points.csv"]\ncorrections = "off"\naccept = ["1mm"]\nout = "by-good"\n',
    "force.toml": 'poecal_settings = 1\nmodel = "robot.urdf"\nmeasurements = ["points.csv"]\nseed = 2\nforce = true\nout = "by-good"\nreport = "none"\n',
    "unknown.toml": 'poecal_settings = 1\nmodel = "robot.urdf"\ncolour = "red"\n',
    "station.toml": """poecal_station = 1
inbox = "inbox/{serial}/{date}.csv"
results = "results/{serial}/{date}"
model = "robot.urdf"
accept = ["0.5mm"]
settings = "line.toml"
reference = "SN0001"

[limits]
"error" = [-inf, 0.3]
"joint2.offset" = [-0.2, 0.2]
""",
    "line.toml": 'poecal_settings = 1\nreport = "none"\ncorrections = "off"\n',
    "MOC.cfg": """MOC:CFG_1.0:6:0::
#
ARM_CALIB:

      -name "rob1_1" -error_offset_x 0.0003 -error_offset_y -0.0002 -error_roll 0.0004
      -name "rob1_2" -error_offset_x 0.0001 -error_pitch -0.0006 -error_jaw 0.0002
#
JOINT_CALIB:

      -name "rob1_2" -Compl 1.2e-07
""",
    "motors.json": "{"
    + ",".join(f'"joint{at}": {{"id": {at}, "drive_mode": 0, "homing_offset": {37 * at - 120}, "range_min": 100, "range_max": 3900}}' for at in range(1, 7))
    + "}\n",
    "part.src": """DEF part()
  $TOOL=$NULLFRAME
  $BASE=$NULLFRAME
  PTP {A1 10,A2 -70,A3 80,A4 20,A5 40,A6 -30} ; start
  LIN {X 820.871,Y -82.910,Z 769.952,A 159.1181,B 35.9821,C 177.7436} C_DIS
  LIN {X 829.239,Y 234.588,Z 743.255,A -143.4099,B 31.1118,C -176.5007}
  PTP XP9
END
""",
    "part.dat": """DEFDAT  PART PUBLIC
DECL E6POS XP1={X 771.121,Y -156.061,Z 795.911,A 150.5028,B 43.2892,C 179.4531,S 2,T 2,E1 0.0}
DECL FDAT FP1={TOOL_NO 1,BASE_NO 7,IPO_FRAME #BASE,POINT2[] " "}
DECL E6AXIS XHOME={A1 -15,A2 -60,A3 70,A4 -10,A5 50,A6 25,E1 0.0}
ENDDAT
""",
    "part.script": """def part():
  set_tcp(p[0, 0, 0, 0, 0, 0])
  movej([0.1745, -1.2217, 1.3963, -1.7453, -1.3963, 0.3491], a=1.4) # start
  movel(p[-0.566535, -0.408171, 0.301744, 2.206289, 1.829789, 0.023214], a=1.2, v=0.25)
  f = p[0.01, 0, 0, 0, 0, 0]
  movel(pose_trans(f, p[-0.602595, -0.279264, 0.309125, 2.292854, 1.909055, 0.181518]))
  movel(pose_add(here, p[0, 0, 0.1, 0, 0, 0]))
end
""",
    "bare.script": "movel(p[-0.566535, -0.408171, 0.301744, 2.206289, 1.829789, 0.023214])\n",
    "no.csv": "",
    "no-rows.csv": "joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg],x[mm],y[mm],z[mm]\n",
    "no.png": "no picture\n",
    "no.json": '{"poecal": 1\n',
}

# A chessboard of 5 x 4 squares in 112 x 88 pixels, of which Pillow 12 wrote them: gray and baseline, coloured and progressive.
BASELINE = """
/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABsSFBcUERsXFhceHBsgKEIrKCUlKFE6PTBCYFVlZF9VXVtqeJmBanGQc1tdhbWGkJ6jq62rZ4C8ybqmx5moq6T/wAALCABYAHABAREA/8QAGgAAAgMBAQ
AAAAAAAAAAAAAABQYAAwQBAv/EACkQAAICAQMDBAIDAQEAAAAAAAECAAMEBRESITFxBjJRUhOBIkFhI5H/2gAIAQEAAD8AOwXr1zVYqBGKkt3BgVNQy07Xv+zvNFWsZgYAuG8iMq7lRv32nZkydRox
bfx2kg7b9BOJqmG/a4DyNpfXk0Wnau1GPwDLZJJJJID9SP1pTyYEl2IvPKqX5YRwHadivrb8tRcfAAmCEtBXlng/VSYyzh6AmLT6vlra3GzddzsCJYmvZI9yI36hXTM5s2tmZAvE7dDNsH6jpgzbFc
2FSBt23mB9AtHsuU+RtPFWn2YF6X5BX8anqRC6anhv2uX99JcuTQ/ttQ+DFbUGL5tzf1yMzQx6cTe61/hdofleQ3CixvhSYmnqTORk9PrxwSfsxMJySQX6gfjhKv2aLk6u+46xvrx6zSiuinZQOonh
9PxH70J+htBmdaNKvCYihQ43YHrPCa/ePfUh8dJcuqnOU4y1cWsHEHeZX0PKXsUbwZQ+lZid6SfBjBpdTU4NaOvFuu4M1zOM7F5FfzICDt1O0sW6p/bYp8GCPUb/AMaVB/smA5ZjLzyK1+WAjkOgE7
FnXX5agR9QBB036GnLUEP1BMaJJJ5c7IT8CJljcrGb5M4CR2Jh3Q6Vuxna5RZ/LYchvNz6bhv3oX9dJkzMDGwqTk1KQ9ZBAJ6bzMmv2j30qfB2l6a/UffSw8HeZcrAyc205NSgpZ1AJ67TK+m5id6G
/XWbdDpanKdrlKfx2HIbQ8CD2InZJRmtwxLW+EMTz3kjNoScdPU/YkwjBuvPxwNvswEWpB3jlirwxql+FAlsBeo3/wClSg9gTBC3WJ7bGHgzZgZmU2VUn5nILDcE7xonl0WxSrgFT3BmR9Kw370geD
KX0PFbsXXwZkTVRgk4y1clrJAO/eXpr9J99Tjx1ledadVpCYilih3YHpBj6flp3of9DeeEosFqqyMu5A6iN67cQB8T1FvX25ZwH1UCDJt0ZeWo1/5uY1SSTjdFMTL253O3yxM8Q96cTaq1/kgQzMup
MEwbm/vjtFdcm9Pba48GXJqeYna5v31hWjT68/HTIyC35XHUjpOPoFR9lzDyN5Zp+lHDyfymwONtu0KSSTxfy/C/EbtxOwinZhZSk70P/wCSlq3X3Iw8iMegJxwd/sxMJQfrj8dPYfYgRYkEcMJeGJ
Uvwol8kkkkkk4VU9wDIqhRsoAH+Tsz5uImZUK7CwAO/SDX9PofZcR5EpOg3BhxsQj/AGH1HFQPgTskk//Z
"""
PROGRESSIVE = """
/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABsSFBcUERsXFhceHBsgKEIrKCUlKFE6PTBCYFVlZF9VXVtqeJmBanGQc1tdhbWGkJ6jq62rZ4C8ybqmx5moq6T/2wBDARweHigjKE4rK06kbl1upKSkpK
SkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKT/wgARCABYAHADASIAAhEBAxEB/8QAGQAAAwEBAQAAAAAAAAAAAAAAAAQFAwIB/8QAFgEBAQEAAAAAAAAAAAAAAAAA
AQAC/9oADAMBAAIQAxAAAAF5VpHCtov3or+hhxEcNFjuZTECZVMnNVuuwUhzRVrTuOJpnY5pV9DwXoz2SLUVH62z7jDYURfZDqpjDZP0HBdrLR1Unv5fQC4j2smlU+ckfW55FE050Vu/PcKCjC2zep
Kq5QAvI1iVqzfRowzlquM7vI0UPGe8qrQUAEAV4BXuYUtwDP8AoEAV/8QAIRAAAQQBBQEBAQAAAAAAAAAAAgABAxMQBBESMTIzIDD/2gAIAQEAAQUCU77DYSaY8lIwvaCYmf8AeowPrE30UHvFpb3k
oz5spI+b0OmjcHsBcmUntaftF1iDxnUeMMzbVijep73VvNUEqjUTbAuYrdlqMD6xP7UP0/D9qBtxrBGAg17q9kQEb1moG2LJ+cQfNT+MD5Wo73dAZcl2qgVAq3gr2Rva1ZLZ98T+1D9Pw/a0/Sk8cn
Vhpo2MaGUcXAsv1wJbKDwp/ngPP8jHm1Cof8//xAAUEQEAAAAAAAAAAAAAAAAAAABQ/9oACAEDAQE/ASv/xAAZEQADAQEBAAAAAAAAAAAAAAABEBEAMCD/2gAIAQIBAT8Bc9TVl3RHgUMeNf8A/8QA
HxAAAgEEAgMAAAAAAAAAAAAAADEBEBESICEwAiJB/9oACAEBAAY/AqPS0jOJ3ikdD0Yy/khjJpNJ60eojGzoiKMZFI7ORGUfBCMo+iOdJ6IpAyOaqmNkI9RbRvNJGMy8mMvfVbx12kY9f//EAB8QAQ
ACAgMBAQEBAAAAAAAAAAEAERAxIUFhIHFRMP/aAAgBAQABPyGMNNcwHvLG7hrJgSdEP29cGy9y7WDf5MpquEOwGOilVikeEeowHVSDdYLoRWvuDzeYVN5k1+n4VA/rglKIaivWcSavcO8QppR4RH+M
QlDO8c9Vg2hHwcCw9yr/ADg2PPh1FacCyb57i3WUk5g7hDucrBxCXeK6a47+FTeZFD3Dr9uTQeYfBAtKNK+8ICnUUlX+kNKxB3qcSbrcR7wqCJDWHf5MC/gdR233B5MOn8gOlAu8JWWj1OdgfF71/I
j3ijYw1+3Cpe5FF5/hRArWB5CJ6nn4EOD4/9oADAMBAAIAAwAAABBSGOmgARBbWUoVUqgMqm4Mo1I2vmoPgNDECAMP976MP//EABkRAAMBAQEAAAAAAAAAAAAAAAEQEQAgMP/aAAgBAwEBPxAu9XRh
zVBHoI4eMf8A/8QAGhEBAAIDAQAAAAAAAAAAAAAAAQARECExIP/aAAgBAgEBPxA7KMEJUC4iYFciLuGuxagXKreFoM6wNRb5A3Lwc8HEOypbFvzbP//EACIQAQACAgICAwADAAAAAAAAAAEAESExEH
FRYSBBgTCRsf/aAAgBAQABPxCCrJ2Gav8AduAAnsSyL3XF9UavBNSDsqK0t4H55+1491CGuKz4A4oXyPDgWZaLNCQ/+NCQ2Vh4FlIK1cPudlRnrGUzNb+mJt30xPrLcX+HTj0YmOV4uXyfIQtZFK1A
yTd/mVBMwNhzCbvWIqVRRuah6mb1PTBDrKx4LFFGstTZjpmMP2vHugEMBxengHFx8F+DpvgnsBgppYBjUUubn8MRc4YQXFw+901H6nTcXmcwLmpufyzEAailQR0nPq5R4tHkvGB8Bwbno4HGFfQs0I
6ZcNEWLfDgRWxm9B0zUPUw03Qg3uO1+sxScnYcTd/mXDXEQySlA8cVB4DjqVvwwU9lJ4r89DgPuMJpX0zU/pmMpTymI/U7Li2wKrXw0K21Ecb/AK5ol2TKeR4pHkHPq4fwKbBgCgB64GoAbxH7jsiA
snuCg8Hw/9k=
"""
WIDTH, HEIGHT = 112, 88


def written(path: Path) -> Path:
    """A path whose folder exists."""
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def take(folder: Path, pattern: str, name: str = "") -> None:
    """Files of this work tree, the only one under another name."""
    found = sorted(ROOT.glob(pattern))
    assert found and (len(found) == 1 or not name), pattern
    for path in found:
        shutil.copyfile(path, written(folder / (name or path.name)))


def seed(folder: Path, source: str, *names: str) -> None:
    """A seed of the fuzzer, whose parts stand between lines of `=====`; a first line that names its form is left out."""
    content = (SEEDS / source).read_bytes()
    head, _, rest = content.partition(b"\n")
    if head in (b"yaml", b"xml", b"csv", b"urscript", b"rapid", b"krl", b"fanuc"):
        content = rest
    for name, part in zip(names, content.split(b"\n=====\n"), strict=True):
        written(folder / name).write_bytes(part)


def text(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).write_text(TEXTS[name], encoding="utf-8")


def arm(folder: Path, name: str) -> None:
    """The model of a maker's arm."""
    axes, place, turns, limits = ARMS[name]
    lines = [
        f'  {{ name = "joint{at}", point = {point}, direction = {direction}, limits = {reach} }},'
        for at, ((point, direction), reach) in enumerate(zip(axes, limits), 1)
    ]
    head = f'poecal_robot = 1\nname = "{name}"\nlength_unit = "mm"\nangle_unit = "deg"\n\njoint = [\n'
    (folder / f"{name}.toml").write_text(head + "\n".join(lines) + f"\n]\n\n[home]\nposition = {place}\nrpy = {turns}\n")


def copy(folder: Path, source: str, name: str) -> None:
    shutil.copyfile(folder / source, written(folder / name))


def replace(folder: Path, source: str, name: str, old: str, new: str) -> None:
    """A file with other words."""
    content = (folder / source).read_text(encoding="utf-8")
    assert old in content, f"{source} has no {old}"
    (folder / name).write_text(content.replace(old, new), encoding="utf-8")


def cut(folder: Path, source: str, name: str, size: str) -> None:
    """The first bytes of a file."""
    (folder / name).write_bytes((folder / source).read_bytes()[: int(size)])


def table(path: Path) -> tuple[list[str], list[str], Rows]:
    """Remarks, header and rows of a table."""
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    return [line for line in lines if line.startswith("#")], rows[0], rows[1:]


def write_table(path: Path, remarks: list[str], header: list[str], rows: Rows) -> None:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([header, *rows])
    written(path).write_text("".join(line + "\n" for line in remarks) + out.getvalue(), encoding="utf-8")


def add(rows: Rows, column: int, value: float) -> None:
    for row in rows:
        row[column] = f"{float(row[column]) + value:.4f}"


def first_of_place(header: list[str]) -> int:
    return next(at for at, name in enumerate(header) if name.startswith("x["))


def outliers(header: list[str], rows: Rows) -> None:
    for at in (7, 21, 40):
        add([rows[at]], first_of_place(header), 20.0 + at)


def negated(_: list[str], rows: Rows) -> None:
    for row in rows:
        row[1] = f"{-float(row[1]):.4f}"


def swapped(_: list[str], rows: Rows) -> None:
    for row in rows:
        row[0], row[1] = row[1], row[0]


def shifted(header: list[str], rows: Rows) -> None:
    at = first_of_place(header)
    places = [row[at : at + 3] for row in rows]
    for row, place in zip(rows, places[1:]):
        row[at : at + 3] = place


def lost(header: list[str], rows: Rows) -> None:
    at = first_of_place(header)
    rows[3][at : at + 3] = ["", "", ""]
    rows[11][at : at + 3] = ["0", "0", "0"]


def joints(header: list[str], rows: Rows) -> None:
    """The table without measured columns, of six joints."""
    for line in [header, *rows]:
        del line[6:]


def places(header: list[str], rows: Rows) -> None:
    """The table without the joints, of which there are six."""
    for line in [header, *rows]:
        del line[:6]


def renamed(header: list[str], old: str, new: str) -> None:
    header[:] = [name.replace(old, new) for name in header]


def with_column(header: list[str], rows: Rows, name: str, values: Callable[[int], str]) -> None:
    header.append(name)
    for at, row in enumerate(rows):
        row.append(values(at))


# Changes of the header and the rows of a table.
CHANGES: dict[str, Callable[[list[str], Rows], object]] = {
    "outliers": outliers,
    "moved": lambda header, rows: add(rows[50:], first_of_place(header), 3.0),
    "slipped": lambda header, rows: add(rows[50:], 1, 0.4),
    "hit": lambda header, rows: add(rows, 3, 0.3),
    "turned": lambda header, rows: add(rows, 0, 0.02),
    "no-column": lambda header, rows: header.__setitem__(1, "shoulder"),
    "twice": lambda header, rows: header.__setitem__(1, header[0]),
    "no-number": lambda header, rows: rows[5].__setitem__(3, "n/a"),
    "infinite": lambda header, rows: rows[5].__setitem__(3, "inf"),
    "short": lambda header, rows: rows[9].pop(),
    "metres": lambda header, rows: renamed(header, "mm", "m"),
    "inches": lambda header, rows: renamed(header, "mm", "in"),
    "radians": lambda header, rows: renamed(header, "deg", "rad"),
    "wrong-unit": lambda header, rows: renamed(header, "mm", "kg"),
    "no-units": lambda header, rows: header.__setitem__(slice(None), [name.split("[")[0] for name in header]),
    "swapped": swapped,
    "negated": negated,
    "shifted": shifted,
    "lost": lost,
    "few": lambda header, rows: rows.__delitem__(slice(8, None)),
    "half": lambda header, rows: rows.__delitem__(slice(len(rows) // 2, None)),
    "one": lambda header, rows: rows.__delitem__(slice(1, None)),
    "repeated": lambda header, rows: rows.extend([list(row) for row in rows[:5]] * 3),
    "joints": joints,
    "places": places,
    "ids": lambda header, rows: with_column(header, rows, "id", lambda at: f"P{at + 1:03}"),
    "stages": lambda header, rows: with_column(header, rows, "stage", lambda at: str(1 + at % 3)),
    "sets": lambda header, rows: with_column(header, rows, "set", lambda at: "held_out" if at % 4 == 3 else "fit"),
    "camera": lambda header, rows: with_column(header, rows, "camera", lambda at: "left"),
    "warmth": lambda header, rows: with_column(header, rows, "temperature", lambda at: f"{20 + 0.1 * at:.1f}"),
}


def change(folder: Path, kind: str, source: str, name: str) -> None:
    """A table with its rows changed, by one change or by several with `+` between them."""
    remarks, header, rows = table(folder / source)
    for word in kind.split("+"):
        CHANGES[word](header, rows)
    write_table(folder / name, remarks, header, rows)


def semicolons(folder: Path, source: str, name: str) -> None:
    """A table as a German program writes it, with Windows line ends."""
    content = (folder / source).read_text(encoding="utf-8").replace(",", ";").replace(".", ",").replace("\n", "\r\n")
    (folder / name).write_bytes(b"\xef\xbb\xbf" + content.encode())


def line_of_robots(folder: Path, source: str, count: str) -> None:
    """Measurements of robots of a line: of one, with other zeros and other noise."""
    for robot in range(int(count)):
        remarks, header, rows = table(folder / source)
        for joint in range(6):
            add(rows, joint, 0.03 * math.sin(1.7 * robot + 2.3 * joint))
        for at, row in enumerate(rows):
            for axis in range(6, 9):
                add([row], axis, 0.04 * math.sin(12.9898 * at + 78.233 * axis + 4.1 * robot))
        write_table(folder / f"inbox/SN{robot:04}/2026-03-{robot % 28 + 1:02}.csv", remarks, header, rows)


def chessboard(x: float, y: float) -> bool:
    """True if a point of the picture is dark: 5 x 4 squares of 19 pixels, turned by 0.12 rad."""
    across, down = x - WIDTH / 2, y - HEIGHT / 2
    i = (across * math.cos(0.12) + down * math.sin(0.12)) / 19 + 2.5
    j = (down * math.cos(0.12) - across * math.sin(0.12)) / 19 + 2
    return 0 <= i < 5 and 0 <= j < 4 and (int(i) + int(j)) % 2 == 0


def shades() -> list[list[float]]:
    """The picture, 0 to 1, with soft edges."""
    steps = (-0.6, -0.2, 0.2, 0.6)
    dark = [[sum(chessboard(x + 0.5 + a, y + 0.5 + b) for a in steps for b in steps) for x in range(WIDTH)] for y in range(HEIGHT)]
    return [[0.88 - 0.72 * count / 16 for count in row] for row in dark]


def png(rows: list[bytes], depth: int, colour: int, *more: bytes, passes: bytes = b"") -> bytes:
    """A PNG of rows of bytes, or of the passes of an interlaced one."""

    def part(name: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

    head = struct.pack(">IIBBBBB", WIDTH, HEIGHT, depth, colour, 0, 0, bool(passes))
    lines = passes or b"".join(b"\0" + row for row in rows)
    return b"\x89PNG\r\n\x1a\n" + part(b"IHDR", head) + b"".join(more) + part(b"IDAT", zlib.compress(lines)) + part(b"IEND", b"")


def interlaced(rows: list[bytes]) -> bytes:
    """The seven passes of Adam7 of a gray picture."""
    ways = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
    return b"".join(b"\0" + row[x::across] for x, y, across, down in ways for row in rows[y::down])


def bits(row: list[float]) -> bytes:
    """A row in black and white, eight pixels a byte."""
    return bytes(sum((shade > 0.5) << (7 - at) for at, shade in enumerate(row[start : start + 8])) for start in range(0, WIDTH, 8))


def palette() -> bytes:
    """The colours of a palette: gray, brownish."""
    colours = bytes(value for shade in range(256) for value in (shade, shade, shade * 3 // 4))
    return struct.pack(">I", len(colours)) + b"PLTE" + colours + struct.pack(">I", zlib.crc32(b"PLTE" + colours))


def jpeg(content: str, orientation: int = 0) -> bytes:
    """A JPEG, with its rotation in its EXIF."""
    picture = base64.b64decode(content.replace("\n", ""))
    if not orientation:
        return picture
    exif = b"Exif\0\0MM\0*" + struct.pack(">IHHHIHHI", 8, 1, 0x0112, 3, 1, orientation, 0, 0)
    return picture[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + picture[2:]


def pictures(folder: Path, name: str) -> None:
    """A folder of pictures of one chessboard in every form, and beside it one of those that stand upright by their EXIF, `turned`."""
    places = shades()
    gray = [bytes(round(255 * shade) for shade in row) for row in places]
    tinted = [[(min(1.0, 1.1 * shade), shade, 0.7 * shade) for shade in row] for row in places]
    made_of = {
        "gray.png": png(gray, 8, 0),
        "gray16.png": png([struct.pack(f">{WIDTH}H", *(round(65535 * shade) for shade in row)) for row in places], 16, 0),
        "bits.png": png([bits(row) for row in places], 1, 0),
        "palette.png": png(gray, 8, 3, palette()),
        "colour.png": png([bytes(round(255 * value) for pixel in row for value in pixel) for row in tinted], 8, 2),
        "colour16.png": png([struct.pack(f">{3 * WIDTH}H", *(round(65535 * value) for pixel in row for value in pixel)) for row in tinted], 16, 2),
        "alpha.png": png([bytes(value for pixel in row for value in (*(round(255 * it) for it in pixel), 200)) for row in tinted], 8, 6),
        "gray-alpha.png": png([bytes(value for shade in row for value in (round(255 * shade), 255)) for row in places], 8, 4),
        "interlaced.png": png([], 8, 0, passes=interlaced(gray)),
        "baseline.jpg": jpeg(BASELINE),
        "progressive.jpeg": jpeg(PROGRESSIVE),
        "turned3.jpg": jpeg(BASELINE, 3),
        "../turned/turned6.jpg": jpeg(BASELINE, 6),
        "../turned/turned8.jpg": jpeg(BASELINE, 8),
    }
    for file, content in made_of.items():
        written(folder / name / file).write_bytes(content)


MAKERS: dict[str, Callable[..., None]] = {
    "take": take,
    "seed": seed,
    "text": text,
    "arm": arm,
    "copy": copy,
    "replace": replace,
    "cut": cut,
    "change": change,
    "semicolons": semicolons,
    "line": line_of_robots,
    "pictures": pictures,
}


def made(maker: str, words: list[str], folder: Path) -> None:
    """Makes files in a folder."""
    try:
        MAKERS[maker](folder, *words)
    except Exception as error:
        raise ValueError(f"in {folder}: @{maker} {' '.join(words)}") from error
