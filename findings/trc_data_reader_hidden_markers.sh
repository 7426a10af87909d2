#!/usr/bin/env bash
# Markers of a TRC file that were hidden for some frames, read by trc-data-reader.
#
# Expected: fields of a hidden marker are empty between their tabs, as motion capture systems write them, and are
# read as nan, or are refused.
# What happens: the line is cut at runs of blanks, so that empty fields vanish, and all markers behind the hidden one
# move up: it gets the coordinates of the marker after it, and the last one is nan. The number of columns
# is not compared with the head, and nothing is said. A hidden last marker is read rightly.
# Whom it hurts: whoever calibrates by markers on a tool or around a cell: a marker that is behind the arm is half a
# metre away, in the frames of just those poses. Write nan or fill the gaps before.
# poecal: reads no TRC, and says so; of a CSV of the same recording empty cells are gaps.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check trc-data-reader==0.4.1
cd "$here"
"$here/venv/bin/python" - <<'PY'
import math
import sys
from importlib.metadata import version
from trc import TRCData

print("trc-data-reader", version("trc-data-reader"))
PLACES = {"tool": (100, 200, 300), "flange": (600, 200, 300), "base": (1100, 200, 300)}


def read(hidden):
    """Frames 3 and 4 of 5 lack one marker."""
    lines = [
        "PathFileType\t4\t(X/Y/Z)\ttake.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        "100.00\t100.00\t5\t3\tmm\t100.00\t1\t5",
        "Frame#\tTime\t" + "\t".join(f"{name}\t\t" for name in PLACES),
        "\t\t" + "\t".join(f"X{i}\tY{i}\tZ{i}" for i in (1, 2, 3)),
        "",
    ]
    for frame in range(1, 6):
        cells = [str(frame), f"{(frame - 1) / 100:.4f}"]
        for name, place in PLACES.items():
            cells += [""] * 3 if name == hidden and frame in (3, 4) else [f"{value:.3f}" for value in place]
        lines.append("\t".join(cells))
    with open("take.trc", "w") as file:
        file.write("\n".join(lines) + "\n")
    data = TRCData()
    data.load("take.trc")
    return {name: data[name][2] for name in PLACES}


unchanged = True
for hidden in (None, *PLACES):
    got = read(hidden)
    print(f"  hidden: {hidden or 'none':7}", "   ".join(f"{name} {'nan' if math.isnan(place[0]) else place}" for name, place in got.items()))
    names = [name for name in PLACES if name != hidden]
    expected = {name: list(PLACES[names[i]]) if i < len(names) else None for i, name in enumerate(PLACES)}
    unchanged = unchanged and all(math.isnan(got[name][0]) if place is None else got[name] == place for name, place in expected.items())
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
