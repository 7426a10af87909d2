#!/usr/bin/env bash
# Points with a finer scale in a LAS file, by laspy.
#
# Expected: coordinates are whole multiples of header.scales. Setting them to 0.1 mm before the coordinates
# makes a file of 0.1 mm.
# What happens: points have scales of their own, which they took from the header when they were made. Set
# afterwards, those of the header change nothing: coordinates are rounded to the 10 mm that laspy.create()
# starts with, and the file states 0.1 mm. Nothing is said, neither when writing nor when reading; a reader
# of the file finds a resolution that its points do not have. change_scaling(), and a header that has its
# scales before LasData is made of it, do what is expected.
# Whom it hurts: whoever writes scans of a cell, a fixture or a target that a robot is registered to: 5 mm
# of each coordinate are gone, fifty times what the file says.
# poecal: reads no point clouds; its tables state coordinates as text.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check laspy==2.7.0 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" - <<'PY'
import sys
import laspy
import numpy as np

print("laspy", laspy.__version__)
POINTS = np.random.default_rng(1).uniform(-5, 5, (1000, 3))
FINE = [1e-4, 1e-4, 1e-4]


def header_of_the_points():
    points = laspy.create()
    points.header.scales = FINE
    return points


def header_before():
    header = laspy.LasHeader(point_format=3, version="1.4")
    header.scales = FINE
    return laspy.LasData(header)


def header_after():
    header = laspy.LasHeader(point_format=3, version="1.4")
    points = laspy.LasData(header)
    header.scales = FINE
    return points


def by_change_scaling():
    points = laspy.create()
    points.change_scaling(scales=FINE)
    return points


unchanged = True
for name, made, fine in (
    ("create(), then header.scales", header_of_the_points, False),
    ("LasData(header), then header.scales", header_after, False),
    ("header.scales, then LasData(header)", header_before, True),
    ("create(), then change_scaling()", by_change_scaling, True),
):
    points = made()
    points.xyz = POINTS
    points.write("one.las")
    with laspy.open("one.las") as file:
        again, stated = file.read(), file.header.scales
    miss = np.abs(again.xyz - POINTS).max()
    print(f"  {name:38} the file states {1000 * stated[0]:.1f} mm, largest miss of a coordinate {1000 * miss:.2f} mm")
    unchanged = unchanged and np.allclose(stated, FINE) and (miss < 6e-5 if fine else miss > 4.5e-3)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
