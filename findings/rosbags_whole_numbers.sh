#!/usr/bin/env bash
# Joint readings that are whole numbers, written into a ROS 2 message with rosbags.
#
# Expected: an array of integers for JointState.position (float64[]) is converted, or refused, as
# float32 is.
# What happens: serialize_cdr takes the eight bytes of each integer as they are. Read back, 1 and 2 rad
# are 5e-324 and 1e-323: zero in every computation. Big-endian numbers, as from instruments or FITS,
# become other tiny ones. No error while writing, none while reading, by whatever reads the bag.
# Whom it hurts: whoever makes a bag of a table that numpy or pandas reads: a column of 0, 90, 45 has
# whole numbers, and configurations in whole degrees or encoder ticks are usual. np.asarray(x, float) helps.
# poecal: reads what is in the bag. Joints that never move are named as not determined, and measurements
# that no arrangement of the readings explains are refused.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check rosbags==0.11.9 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from rosbags.typesys import Stores, get_typestore

print("rosbags", version("rosbags"))
store = get_typestore(Stores.ROS2_HUMBLE)
JOINTS = "sensor_msgs/msg/JointState"
Header, Time = store.types["std_msgs/msg/Header"], store.types["builtin_interfaces/msg/Time"]


def written_and_read(values):
    none = np.array([])
    message = store.types[JOINTS](Header(Time(1, 0), "base"), ["joint1", "joint2"], values, none, none)
    try:
        return store.deserialize_cdr(store.serialize_cdr(message, JOINTS), JOINTS).position
    except ValueError:
        return None


got = {
    "float64": written_and_read(np.array([1.0, 2.0])),
    "int64": written_and_read(np.array([1, 2], dtype=np.int64)),
    "float64, big-endian": written_and_read(np.array([1.0, 2.0], dtype=">f8")),
    "float32": written_and_read(np.array([1.0, 2.0], dtype=np.float32)),
}
print("1 and 2 rad, written and read:")
for name, values in got.items():
    print(f"  {name:20} {'refused' if values is None else values}")
unchanged = np.array_equal(got["float64"], [1, 2]) and got["float32"] is None
unchanged = unchanged and all(0 < abs(got[name]).max() < 1e-300 for name in ("int64", "float64, big-endian"))
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
