"""The stubs of the package are what it is, and what uses it is well typed."""

import subprocess
import sys

import pytest
from program import ROOT

EXAMPLES = sorted((ROOT / "examples/python").glob("*.py"))
CHECKS = {
    "stubs": ["mypy.stubtest", "poecal"],
    "package": ["mypy", "--strict", "-p", "poecal"],
    # Packages that an example needs may be absent, or without types.
    "examples": ["mypy", "--strict", "--ignore-missing-imports", "--scripts-are-modules", *EXAMPLES],
    "bench": ["mypy", "--strict", ROOT / "crates/poecal-py/benches/overhead.py"],
}


@pytest.mark.parametrize("check", CHECKS)
def test_types_are_right(check, tmp_path):
    command = [sys.executable, "-m", *map(str, CHECKS[check])]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
