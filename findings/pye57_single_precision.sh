#!/usr/bin/env bash
# Coordinates in double precision, written into an E57 file by pye57.
#
# Expected: write_scan_raw writes the float64 arrays that it is given; the format has both precisions, and
# read_scan returns float64.
# What happens: coordinates are stored as float32, whatever they are given as, and are read back as float64
# with seven digits: off by 0.2 um at 5 m, and by 0.25 m in UTM coordinates. The pose of the scan, beside
# them, keeps all of its digits. There is no argument to choose the precision, and nothing is said.
# Whom it hurts: whoever writes points of a surveyed hall or of a work cell in coordinates of a plant. Take
# the middle off the points and state it as the translation of the scan: then they are exact to a micrometre.
# poecal: reads no point clouds; numbers of its tables are doubles.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pye57==0.4.19 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
import pye57

print("pye57", version("pye57"))
NAMES = ("cartesianX", "cartesianY", "cartesianZ")
ROOM = np.random.default_rng(1).uniform(-5, 5, (1000, 3))


def written_and_read(name, points, **pose):
    file = pye57.E57(name, mode="w")
    file.write_scan_raw(dict(zip(NAMES, np.ascontiguousarray(points.T))), **pose)
    file.close()
    file = pye57.E57(name)
    scan = file.read_scan(0, ignore_missing_fields=True)
    file.close()
    return np.stack([scan[each] for each in NAMES], axis=1)


unchanged = True
for name, middle, least, most in (("a room", (0, 0, 0), 1e-8, 1e-6), ("a plant, 2 km", (1500, 900, 10), 1e-5, 1e-3), ("UTM", (691000, 5336000, 520), 0.1, 0.3)):
    points = ROOM + middle
    plain = written_and_read(f"{name}.e57", points)
    turn, place = np.array([1.0, 0.0, 0.0, 0.0]), np.array(middle, float)
    apart = written_and_read(f"{name}, apart.e57", points - place, rotation=turn, translation=place)
    misses = [1000 * np.abs(each - points).max() for each in (plain, apart)]
    print(f"  {name:14} read as {plain.dtype}: largest miss {misses[0]:12.6f} mm, with the middle as translation {misses[1]:.6f} mm")
    unchanged = unchanged and plain.dtype == np.float64 and 1000 * least < misses[0] < 1000 * most and misses[1] < 1e-3
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
