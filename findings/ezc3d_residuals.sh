#!/usr/bin/env bash
# Residuals of markers in a C3D file, written and read by ezc3d.
#
# Expected: points and their residuals, the errors that a motion capture system states for each marker, come
# back as float32, since that is what the file holds.
# What happens: points do. For a residual the format has one byte, in units of POINT:SCALE, also in files of
# floats, and ezc3d leaves SCALE at 1 and rounds towards zero: residuals below 1, as all are in metres and
# good ones in millimetres, are read as exactly 0, and 3.7 as 3. With a finer SCALE what is above 255 units
# wraps around: 1.3 with a SCALE of 0.001 is read as 0.02, smaller than the residual of 0.25 beside it. The
# documentation names neither the byte nor SCALE, and nothing is said.
# Whom it hurts: whoever weighs markers by them, or leaves out those above a limit: all seem perfect, or a
# bad marker seems the best. Set SCALE to the largest residual over 255.
# poecal: reads no C3D files. In a table, sigma_position of a row has all digits that it was given.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check ezc3d==1.7.2 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import ezc3d
import numpy as np

print("ezc3d", version("ezc3d"))
GIVEN = np.array([0.0004, 0.25, 0.75, 1.3, 3.7])


def written_and_read(scale):
    file = ezc3d.c3d()
    points = file["parameters"]["POINT"]
    points["RATE"]["value"], points["LABELS"]["value"], points["UNITS"]["value"] = [100.0], ["marker"], ["mm"]
    if scale is not None:
        file.add_parameter("POINT", "SCALE", [-scale])  # negative: the numbers are floats
    at = np.ones((4, 1, len(GIVEN)))
    at[:3] = 123.456789
    file["data"]["points"] = at
    file["data"]["meta_points"]["residuals"] = GIVEN.reshape(1, 1, -1)
    file.write("one.c3d")
    again = ezc3d.c3d("one.c3d")
    assert np.allclose(again["data"]["points"][:3], 123.456789, rtol=1e-7)
    return again["data"]["meta_points"]["residuals"].ravel()


got = {scale: written_and_read(scale) for scale in (None, 0.1, 3.7 / 255, 0.001)}
print("residuals given        ", *(f"{value:8.4f}" for value in GIVEN))
for scale, values in got.items():
    print(f"  read, SCALE {'not set' if scale is None else f'{scale:.5f}':9}", *(f"{value:8.4f}" for value in values))
unchanged = np.allclose(got[None], [0, 0, 0, 1, 3], atol=1e-6)
unchanged = unchanged and np.allclose(got[3.7 / 255], GIVEN, atol=3.8 / 255)
unchanged = unchanged and abs(got[0.001][1] - 0.25) < 0.0011 and got[0.001][3] < 0.03 and got[0.001][4] < 0.2
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
