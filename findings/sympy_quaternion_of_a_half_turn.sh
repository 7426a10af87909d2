#!/usr/bin/env bash
# The quaternion of a rotation matrix, by SymPy.
#
# Expected: Quaternion.from_rotation_matrix gives the quaternion of every rotation matrix: diag(1, -1, -1), a tool
# that looks down, is 0 + 1 i + 0 j + 0 k.
# What happens: the signs of i, j and k are those of differences across the diagonal, which are zero for a half
# turn. For matrices of exact numbers the quaternion is zero, of no rotation. For floats, where a difference is
# zero but for rounding, signs are random and parts are lost: the axis is another one for half of all half turns,
# by up to 72 degrees, and some have imaginary parts. Nothing is said. Turns up to 3.1 rad are exact.
# Whom it hurts: whoever derives kinematics with SymPy: bases and flanges turned by 180 degrees stand in every other
# robot's description.
# poecal: takes the quaternion of the largest of four parts, so that half turns are exact to rounding.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check sympy==1.14.0 mpmath==1.3.0 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from scipy.spatial.transform import Rotation
from sympy import Matrix, diag
from sympy.algebras.quaternion import Quaternion

print("SymPy", version("sympy"))
unchanged = True
for matrix in (diag(1, -1, -1), diag(-1, -1, 1), Matrix([[0, 1, 0], [1, 0, 0], [0, 0, -1]])):
    found = Quaternion.from_rotation_matrix(matrix)
    print(f"  {matrix.tolist()}: {found}")
    unchanged = unchanged and found == Quaternion(0, 0, 0, 0)

random = np.random.default_rng(1)
print("200 random axes: most degrees off, how many by more than 1, how many with imaginary parts")
for name, low, high in (("turns of 0.1 to 3.1 rad", 0.1, 3.1), ("half turns", np.pi, np.pi)):
    off, imaginary = [], 0
    for _ in range(200):
        axis = random.normal(size=3)
        given = Rotation.from_rotvec(axis / np.linalg.norm(axis) * random.uniform(low, high))
        parts = [complex(part) for part in Quaternion.from_rotation_matrix(Matrix(given.as_matrix())).args[:4]]
        imaginary += max(abs(part.imag) for part in parts) > 1e-12
        found = Rotation.from_quat([part.real for part in parts], scalar_first=True)
        off.append(np.degrees((found.inv() * given).magnitude()))
    wrong = sum(it > 1 for it in off)
    print(f"  {name:24} {max(off):7.3f} {wrong:4} {imaginary:4}")
    unchanged = unchanged and ((wrong > 60 and max(off) > 45 and imaginary > 5) if low == high else (max(off) < 1e-6 and not imaginary))
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
