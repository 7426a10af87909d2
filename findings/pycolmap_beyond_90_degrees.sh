#!/usr/bin/env bash
# Pixels of a fisheye lens that look more than 90 degrees off the axis, in pycolmap.
#
# Expected: cam_from_img gives x/z and y/z of the ray of a pixel. A ray beyond 90 degrees has none, so None,
# as img_from_cam gives None for a point that is not in front of the camera.
# What happens: the angle itself stands where its tangent should: 91 degrees come back as 1.588, which is a ray
# at 58 degrees, and 110 degrees as one at 62. So it is with all six fisheye models here; up to 89 degrees each
# is exact to 1e-6 degrees. Nothing is said. The function may return None by its signature, and does not.
# Whom it hurts: whoever takes rays, undistorted points or poses of a camera of 190 degrees or more by it: what
# lies at the rim is a third of a right angle off, and looks like a point well inside. Keep pixels that
# img_from_cam leads back to; for others it gives a pixel that is hundreds of px away.
# poecal: takes rays of a fisheye as directions, not as slopes, up to 149 degrees off the axis.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pycolmap==4.2.1 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
import pycolmap

print("pycolmap", version("pycolmap"))
FOCAL, CENTER = 500.0, 1200.0
CENTERED = [CENTER, CENTER]
BENDS = {  # parameters, and radius in focal lengths by angle
    "SIMPLE_FISHEYE": ([FOCAL, *CENTERED], 0, 0),
    "FISHEYE": ([FOCAL, FOCAL, *CENTERED], 0, 0),
    "SIMPLE_RADIAL_FISHEYE": ([FOCAL, *CENTERED, 0.02], 0.02, 0),
    "RADIAL_FISHEYE": ([FOCAL, *CENTERED, 0.02, 0.002], 0.02, 0.002),
    "OPENCV_FISHEYE": ([FOCAL, FOCAL, *CENTERED, 0.02, 0.002, 0, 0], 0.02, 0.002),
    "THIN_PRISM_FISHEYE": ([FOCAL, FOCAL, *CENTERED, 0.02, 0.002] + 6 * [0], 0.02, 0.002),
}


def pixel(angle, k1, k2):
    radius = angle * (1 + k1 * angle**2 + k2 * angle**4)
    return np.array([CENTER + FOCAL * radius * 0.6, CENTER + FOCAL * radius * 0.8])


unchanged = True
print("degrees off the axis of the ray that cam_from_img gives for a pixel at")
DEGREES = (30, 60, 80, 89, 91, 95, 100, 110)
print(f"  {'':22}" + "".join(f"{degrees:9}" for degrees in DEGREES) + "   and back at 100, px off")
for name, (parameters, k1, k2) in BENDS.items():
    camera = pycolmap.Camera(model=name, width=2400, height=2400, params=parameters)
    rays = {}
    for degrees in DEGREES:
        given = pixel(np.radians(degrees), k1, k2)
        found = camera.cam_from_img(given)
        rays[degrees] = np.degrees(np.arctan(np.linalg.norm(found)))
        if degrees < 90:
            unchanged = unchanged and abs(rays[degrees] - degrees) < 1e-6
        else:
            unchanged = unchanged and abs(np.linalg.norm(found) - np.radians(degrees)) < 1e-9
    found = camera.cam_from_img(pixel(np.radians(100), k1, k2))
    back = np.linalg.norm(camera.img_from_cam(np.array([*found, 1.0])) - pixel(np.radians(100), k1, k2))
    print(f"  {name:22}" + "".join(f"{rays[degrees]:9.3f}" for degrees in DEGREES) + f"{back:9.1f}")
    unchanged = unchanged and back > 200 and camera.img_from_cam(np.array([1.0, 0.0, -0.1])) is None
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
