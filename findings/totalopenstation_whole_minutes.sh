#!/usr/bin/env bash
# Angles in degrees, minutes and seconds of a Leica GSI file, read by Total Open Station.
#
# Expected: 12°29'00", which the file has as 01229000, is 12.4833°, and the point is where it was measured.
# What happens: the number becomes 12.29, and its minutes are cut off a product in binary: 28.9999999 is 28 minutes and
# 99.99 seconds, which is 40" more. Of the angles of whole minutes almost half are turned by 40", 1.9 mm at
# 10 m; those with any seconds are right. So, of points measured in whole seconds, one in 60 is off,
# horizontally, vertically or both, and nothing is said. Files in gon are read rightly.
# Whom it hurts: whoever measures a cell, a track or a base by total station: a few points are off by ten times the
# noise, and look like mistakes of the operator. Set the instrument to gon.
# poecal: reads no GSI, and says so; it takes points as x, y, z.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check totalopenstation==0.7.2
HOME=$here "$here/venv/bin/python" - <<'PY'
import math
import random
import sys
from importlib.metadata import version
from totalopenstation.formats.leica_gsi import FormatParser

print("totalopenstation", version("totalopenstation"))
random.seed(1)
DISTANCE = 10.0


def missed(angles, unit):
    """Points of the file apart from where they were measured, in mm: angles are (horizontal, zenith) in seconds of arc."""
    def word(seconds):
        if unit == "dms":
            return f"{seconds // 3600:03d}{seconds // 60 % 60:02d}{seconds % 60:02d}0"
        return f"{round(seconds / 3600 / 0.9 * 1e5):08d}"

    digit = {"dms": 4, "gon": 2}[unit]
    rows = [
        f"11{number:04d}+{number:08d} 21.10{digit}+{word(around)} 22.10{digit}+{word(down)} 31..00+{round(1000 * DISTANCE):08d} 87..10+00000000"
        for number, (around, down) in enumerate(angles, 1)
    ]
    points = FormatParser("\n".join(rows)).points
    apart = []
    for point, (around, down) in zip(points, angles, strict=True):
        around, down = (math.radians(seconds / 3600) for seconds in (around, down))
        place = DISTANCE * math.sin(down) * math.sin(around), DISTANCE * math.sin(down) * math.cos(around), DISTANCE * math.cos(down)
        apart.append(1000 * math.dist((point.geometry.x, point.geometry.y, point.geometry.z), place))
    return apart


minutes = [(60 * minute, 90 * 3600) for minute in range(360 * 60)]
seconds = [(random.randrange(360 * 3600), random.randrange(60 * 3600, 120 * 3600)) for _ in range(7000)]
unchanged = True
for name, angles, unit, shares in (
    ("whole minutes, DMS", minutes, "dms", (0.3, 0.5)),
    ("whole seconds, DMS", seconds, "dms", (0.008, 0.02)),
    ("whole seconds, gon", seconds, "gon", (0, 0)),
):
    apart = missed(angles, unit)
    share = sum(miss > 0.5 for miss in apart) / len(apart)
    print(f"  {name}: {len(apart)} points at 10 m, {100 * share:.2f} % off by more than 0.5 mm, the worst by {max(apart):.2f} mm")
    unchanged = unchanged and shares[0] <= share <= shares[1] and (max(apart) > 1.5 if shares[0] else max(apart) < 0.5)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
