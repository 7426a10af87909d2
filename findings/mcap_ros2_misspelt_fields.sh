#!/usr/bin/env bash
# A ROS 2 message written as a dict with mcap-ros2-support, a name in it misspelt.
#
# Expected: a key that the message does not have is refused, as every ROS client refuses it, and so is a
# field that is left out.
# What happens: keys without a field are dropped, and fields without a key are zero or empty. "nsec" for
# "nanosec", the name of ROS 1, makes all stamps whole seconds; "positions" for "position" makes joint
# readings empty; sec=1.5 becomes 1. No error while writing, none while reading.
# Whom it hurts: whoever makes a bag of a log of a controller or a tracker: readings are then paired with
# poses that are up to a second away, which for an arm that moves is any distance.
# poecal: refuses to pair recordings by times that are mostly the same, and says so ("write them with
# fractions of a second"); a message without the readings of its joints is refused too.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check mcap-ros2-support==0.6.0 mcap==1.6.0
"$here/venv/bin/python" - <<'PY'
import io
import sys
from importlib.metadata import version
from mcap_ros2.reader import read_ros2_messages
from mcap_ros2.writer import Writer

print("mcap-ros2-support", version("mcap-ros2-support"))
LINE = "=" * 80
JOINTS = f"""std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
{LINE}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{LINE}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def written_and_read(stamp, **fields):
    file = io.BytesIO()
    writer = Writer(file)
    schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINTS)
    message = {"header": {"stamp": stamp, "frame_id": ""}, "name": ["joint1"], "velocity": [], "effort": [], **fields}
    writer.write_message("/joint_states", schema, message, log_time=0, publish_time=0)
    writer.finish()
    file.seek(0)
    read = next(iter(read_ros2_messages(file))).ros_msg
    return read.header.stamp.sec + read.header.stamp.nanosec * 1e-9, list(read.position)


half = {"sec": 1, "nanosec": 500_000_000}
cases = {
    "as it should be": ((half, {"position": [0.7]}), (1.5, [0.7])),
    "nsec for nanosec": (({"sec": 1, "nsec": 500_000_000}, {"position": [0.7]}), (1.0, [0.7])),
    "sec=1.5": (({"sec": 1.5}, {"position": [0.7]}), (1.0, [0.7])),
    "positions for position": ((half, {"positions": [0.7]}), (1.5, [])),
    "no position": ((half, {}), (1.5, [])),
}
unchanged = True
print("a reading of 0.7 rad at 1.5 s, written and read:")
for name, ((stamp, fields), expected) in cases.items():
    got = written_and_read(stamp, **fields)
    print(f"  {name:24} {got[0]} s, position {got[1]}")
    unchanged = unchanged and got == expected
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
