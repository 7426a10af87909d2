#!/usr/bin/env bash
# A graph of poses, written as g2o by GTSAM.
#
# Expected: writeG2o writes numbers that readG2o reads back as they were, or nearly: it is text, and there is
# no setting of precision.
# What happens: all numbers have six digits, whatever their size and the noise of their factor. A pose at 5336123 m,
# a northing of a plant, is read back as 5336120: up to 5 m off. Of a cell in millimetres poses are 5 um off, and
# measurements that agree with each other to the last digit, with sigmas of 1 um and 1 urad, do not any more: the
# error of the graph at its optimum is 163 in place of 0, and noise of that size would make it 63. Nothing is said.
# Whom it hurts: whoever keeps a network of stations, a hall or the poses of a calibration in this format and
# reads them elsewhere. Take the middle off coordinates of a plant first.
# poecal: reads and writes no g2o; poses of its results have all digits.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check gtsam==4.3.0 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import gtsam
import numpy as np

print("gtsam", version("gtsam"))
random = np.random.default_rng(1)


def graph_of(middle, extent, sigma_turn, sigma_place):
    """Poses around a middle, all measured from each other without error, and their values."""
    noise = gtsam.noiseModel.Diagonal.Sigmas(np.array(3 * [sigma_turn] + 3 * [sigma_place]))
    poses = [gtsam.Pose3(gtsam.Rot3.RzRyRx(*random.uniform(-1, 1, 3)), middle + random.uniform(-extent, extent, 3)) for _ in range(8)]
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    for i, pose in enumerate(poses):
        values.insert(i, pose)
        for j in range(i):
            graph.add(gtsam.BetweenFactorPose3(j, i, poses[j].between(pose), noise))
    return graph, values, poses


unchanged = True
for name, middle, extent, sigma_turn, sigma_place in (
    ("cell, in millimetres", np.zeros(3), 3000.0, 1e-6, 0.001),
    ("cell, in metres", np.zeros(3), 3.0, 1e-6, 1e-6),
    ("plant, in metres", np.array([691234.567, 5336123.456, 520.0]), 100.0, 1e-5, 1e-3),
):
    graph, values, poses = graph_of(middle, extent, sigma_turn, sigma_place)
    gtsam.writeG2o(graph, values, "cell.g2o")
    read, found = gtsam.readG2o("cell.g2o", True)
    places = max(np.abs(found.atPose3(i).translation() - pose.translation()).max() for i, pose in enumerate(poses))
    turns = max(np.linalg.norm(gtsam.Rot3.Logmap(pose.rotation().between(found.atPose3(i).rotation()))) for i, pose in enumerate(poses))
    read.add(gtsam.PriorFactorPose3(0, poses[0], gtsam.noiseModel.Isotropic.Sigma(6, 1e-9)))
    best = gtsam.LevenbergMarquardtOptimizer(read, values).optimize()
    rows = 6 * 28 - 6 * 7
    print(f"  {name:22} values off by {places:.3g} and {1e6 * turns:.2f} urad; error of the graph {graph.error(values):.3g}, read back {read.error(values):.3g}, at its optimum {read.error(best):.3g} ({rows / 2:.0f} are expected of noise)")
    unchanged = unchanged and graph.error(values) < 1e-6 and places > (1 if middle.any() else 1e-6 * extent)
    unchanged = unchanged and (middle.any() or read.error(best) > 100)
print(open("cell.g2o").readline().strip())
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
