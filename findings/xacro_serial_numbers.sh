#!/usr/bin/env bash
# The serial number of a robot in the name of its calibration file, by xacro.
#
# Expected: a property or an argument of a macro that is used as text stays the text that it was given, as `$(arg serial)`
# does: serial:=0042 leads to calibration_0042.yaml.
# What happens: a value that can be read as a number becomes one as soon as it passes through `<xacro:property>` or a
# macro's parameter: 0042 is 42, 3.10 is 3.1, and 12E4 is 120000.0, while 1_2 and 0x1F stay. The number is
# then written into the name. Nothing is said, and the documentation speaks of numbers in expressions alone.
# Whom it hurts: whoever picks the calibration of an arm by its serial number, or a tool by its revision: the file
# of another robot is loaded if there is one of that name, and else the run ends. Begin such names with a letter.
# poecal: names of results are the user's; `--format origins` is a file of one robot, whose name is never computed.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check xacro==2.1.1 PyYAML==6.0.3
cd "$here"
cat > arm.urdf.xacro <<'XML'
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="serial" default="none"/>
  <xacro:property name="serial" value="$(arg serial)"/>
  <xacro:macro name="stage" params="revision">
    <text of="parameter">tool_${revision}</text>
  </xacro:macro>
  <xacro:property name="origin" value="${xacro.load_yaml('calibration_' + str(serial) + '.yaml')}"/>
  <text of="argument">calibration_$(arg serial).yaml</text>
  <text of="property">calibration_${serial}.yaml</text>
  <xacro:stage revision="$(arg serial)"/>
  <origin xyz="${origin['x']} 0 0"/>
</robot>
XML
"$here/venv/bin/python" - <<'PY'
import re
import sys
from importlib.metadata import version
from pathlib import Path
import xacro

print("xacro", version("xacro"))
for robot, x in (("0042", 0.4031), ("42", 0.3968), ("3.1", 1), ("3.10", 2), ("120000.0", 3), ("12E4", 4), ("1_2", 5), ("0x1F", 6)):
    Path(f"calibration_{robot}.yaml").write_text(f"x: {x}\n")


def processed(serial):
    text = xacro.process_file("arm.urdf.xacro", mappings={"serial": serial}).toxml()
    names = dict(re.findall(r'<text of="(\w+)">([^<]*)</text>', text))
    return names, float(re.search(r'<origin xyz="([^ ]*)', text)[1])


EXPECTED = {"0042": "42", "3.10": "3.1", "12E4": "120000.0", "1_2": "1_2", "0x1F": "0x1F"}
unchanged = True
for serial, becomes in EXPECTED.items():
    names, x = processed(serial)
    print(f"  serial:={serial:5} argument {names['argument']}, property {names['property']}, parameter {names['parameter']}")
    unchanged = unchanged and names == {
        "argument": f"calibration_{serial}.yaml", "property": f"calibration_{becomes}.yaml", "parameter": f"tool_{becomes}"}
    if serial == "0042":
        print(f"    loaded: x of {x} m; the file of 0042 has 0.4031, that of 42 has 0.3968: {1000 * abs(x - 0.4031):.1f} mm")
        unchanged = unchanged and x == 0.3968
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
