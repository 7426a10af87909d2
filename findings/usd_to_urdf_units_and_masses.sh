#!/usr/bin/env bash
# A USD robot in centimetres, or with links whose frames are not at their joints, by NVIDIA's usd_to_urdf.
#
# Expected: a URDF in metres, whatever `metersPerUnit` of the stage is; centres of gravity where they are in USD.
# What happens: lengths are written as they are in the stage. A robot in centimetres, which is also what USD reads
# where a stage states no unit, is 100 times too large. And since a link of a URDF is at its joint, what is seen
# of a link is moved there, by localPos1 of the joint, but its mass is not: the centre of gravity keeps the
# numbers that it had in the frame of the body. An arm whose frame is in its middle, 0.2 m from the joint, has its
# centre of gravity 0.2 m from where it is. In metres, with frames at joints, all is right. There is no warning.
# Whom it hurts: whoever takes a robot from a USD stage to a calibration, to ROS or to a controller: torques and the
# sag of links are computed with wrong levers, while the picture is right.
# poecal: reads no USD. What it writes is in metres, states that, and has the frames of links at their joints, which
# the converter reads right.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check nvidia-srl-usd-to-urdf==1.0.3 usd-core==25.11 numpy==1.26.4
cd "$here"
cat > run.py <<'PY'
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from importlib.metadata import version
from pathlib import Path
import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

print(", ".join(f"{name} {version(name)}" for name in ("nvidia-srl-usd-to-urdf", "usd-core")))
JOINT, CENTRE = np.array([0.0, 0.0, 0.5]), np.array([0.0, 0.0, 0.05])  # of the joint in the base, of gravity in the body, metres


def converted(unit, stated, body):
    """Origin of the joint, centre of gravity and centre of the box of the arm's URDF; `body` is the joint's place in the body's frame, metres."""
    stage = Usd.Stage.CreateInMemory()
    if stated:
        UsdGeom.SetStageMetersPerUnit(stage, unit)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/robot").GetPrim())
    for name, place in (("base", np.zeros(3)), ("arm", JOINT - body)):
        link = UsdGeom.Xform.Define(stage, f"/robot/{name}")
        link.AddTranslateOp().Set(Gf.Vec3d(*(place / unit).tolist()))
        UsdPhysics.RigidBodyAPI.Apply(link.GetPrim())
        mass = UsdPhysics.MassAPI.Apply(link.GetPrim())
        mass.CreateMassAttr(3.0)
        mass.CreateCenterOfMassAttr(Gf.Vec3f(*(CENTRE / unit).tolist()))
        mass.CreateDiagonalInertiaAttr(Gf.Vec3f(0.01 / unit**2))
        box = UsdGeom.Cube.Define(stage, f"/robot/{name}/box")
        box.CreateSizeAttr(0.1 / unit)
        box.AddTranslateOp().Set(Gf.Vec3d(*(CENTRE / unit).tolist()))  # where the centre of gravity is
    joint = UsdPhysics.RevoluteJoint.Define(stage, "/robot/joint")
    joint.CreateAxisAttr("Y")
    joint.CreateBody0Rel().SetTargets(["/robot/base"])
    joint.CreateBody1Rel().SetTargets(["/robot/arm"])
    joint.CreateLocalPos0Attr(Gf.Vec3f(*(JOINT / unit).tolist()))
    joint.CreateLocalPos1Attr(Gf.Vec3f(*(body / unit).tolist()))
    joint.CreateLowerLimitAttr(-90.0)
    joint.CreateUpperLimitAttr(90.0)
    stage.Export("arm.usda")
    done = subprocess.run([Path(sys.executable).parent / "usd_to_urdf", "arm.usda", "-o", "arm.urdf"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr[-2000:])
    robot = ElementTree.parse("arm.urdf").getroot()
    (joint,) = (each for each in robot.iter("joint") if each.get("name") == "joint")
    (arm,) = (each for each in robot.iter("link") if each.get("name") == "arm")
    places = joint.find("origin"), arm.find("inertial/origin"), arm.find("visual/origin")
    warned = [word for word in ("WARN", "ERROR") if word in done.stdout + done.stderr]
    return [np.array(each.get("xyz").split(), float) for each in places], warned, UsdGeom.GetStageMetersPerUnit(Usd.Stage.Open("arm.usda"))


unchanged = True
for name, unit, stated, body in (
    ("metres, link at its joint", 1.0, True, np.zeros(3)),
    ("centimetres, link at its joint", 0.01, True, np.zeros(3)),
    ("no unit stated, link at its joint", 0.01, False, np.zeros(3)),
    ("metres, link at its middle", 1.0, True, np.array([0.0, 0.0, -0.2])),
):
    (origin, gravity, seen), warned, read = converted(unit, stated, body)
    print(f"  {name:34} unit {read:4} m: joint at {origin}, arm seen at {seen}, centre of gravity {gravity}, by USD both {CENTRE - body} m, warnings {warned or 'none'}")
    unchanged = unchanged and not warned and read == unit and np.allclose(origin, JOINT / unit) and np.allclose(seen, (CENTRE - body) / unit)
    unchanged = unchanged and np.allclose(gravity, CENTRE / unit)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
"$here/venv/bin/python" run.py
