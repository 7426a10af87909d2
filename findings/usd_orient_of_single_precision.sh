#!/usr/bin/env bash
# Small turns of USD prims whose orientation has single precision, in OpenUSD, and of a URDF that is converted to USD.
#
# Expected: xformOp:orient is a quaternion; in single precision its parts are good to 6e-8, and so are turns.
# What happens: OpenUSD makes an angle of the quaternion by the arc cosine of w, which in single precision is 1 for
# all turns below 3.4e-4 rad. Transforms of prims have none of these; 5e-4 rad are 38 % more and 1e-3 rad 2 % less.
# The quaternion itself is in the file to seven digits, and Gf.Matrix3d of it is right: only transforms, and
# Gf.Rotation, are not. Orientations of double precision are exact. urdf-usd-converter goes through such transforms,
# so that its joints have these angles too: a URDF with small corrections comes out without them. Nothing is said.
# Whom it hurts: whoever has a calibrated robot or cell in USD, whose corrections are of this size: 0.3 mm at 1 m.
# poecal: writes orientations of links in double precision, and joint frames, which USD has in single precision
# only, as quaternions whose parts are good to 6e-8.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check urdf-usd-converter==0.3.4 numpy==2.4.6
python3 -m venv "$here/usd"
"$here/usd/bin/pip" install -q --disable-pip-version-check usd-core==26.11
cd "$here"
"$here/usd/bin/python" - <<'PY'
import math
import sys
from importlib.metadata import version
from pxr import Gf, Usd, UsdGeom

print("usd-core", version("usd-core"))
unchanged = True
print("turn about x, rad: of the prim, single precision, double precision; of Gf.Matrix3d of the same quaternion")
for turn in (1e-4, 3e-4, 5e-4, 1e-3, 1e-2, 1e-1):
    half = turn / 2
    single = Gf.Quatf(math.cos(half), Gf.Vec3f(math.sin(half), 0, 0))
    double = Gf.Quatd(math.cos(half), Gf.Vec3d(math.sin(half), 0, 0))
    stage, found = Usd.Stage.CreateInMemory(), []
    for name, precision, value in (("s", UsdGeom.XformOp.PrecisionFloat, single), ("d", UsdGeom.XformOp.PrecisionDouble, double)):
        prim = UsdGeom.Xform.Define(stage, f"/{name}")
        prim.AddOrientOp(precision).Set(value)
        found.append(math.asin(prim.GetLocalTransformation()[1][2]))
    by_matrix = math.asin(Gf.Matrix3d(Gf.Quatd(single))[1][2])
    print(f"  {turn:.0e}  {found[0]:.7f}  {found[1]:.7f}  {by_matrix:.7f}")
    unchanged = unchanged and abs(found[1] / turn - 1) < 1e-6 and abs(by_matrix / turn - 1) < 1e-6
    unchanged = unchanged and {1e-4: found[0] == 0, 3e-4: found[0] == 0, 5e-4: found[0] > 6.5e-4, 1e-3: found[0] < 9.8e-4}.get(turn, True)
sys.exit(not unchanged)
PY
for turn in 0.0001 0.001; do
cat > robot.urdf <<URDF
<robot name="one"><link name="base"/><link name="arm"/><joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
<origin xyz="0 0 0.3" rpy="$turn 0 0"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint></robot>
URDF
"$here/venv/bin/urdf_usd_converter" robot.urdf "out$turn" --no-layer-structure > log.txt 2>&1
done
"$here/usd/bin/python" - <<'PY'
import glob
import sys
from pxr import Usd, UsdPhysics

print("urdf-usd-converter 0.3.4: roll of the joint in the URDF, in the USD")
unchanged = True
for turn, least, most in (("0.0001", -1e-9, 1e-9), ("0.001", 9.6e-4, 9.8e-4)):
    stage = Usd.Stage.Open(glob.glob(f"out{turn}/*.usd*")[0])
    joint = next(UsdPhysics.Joint(prim) for prim in stage.Traverse() if prim.GetName() == "turn")
    found = 2 * joint.GetLocalRot0Attr().Get().GetImaginary()[0]
    print(f"  {turn}  {found:.7f}")
    unchanged = unchanged and least < found < most
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
