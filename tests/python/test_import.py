"""The installed package is the one of this workspace."""

import re
from pathlib import Path

import poecal

ROOT = Path(__file__).resolve().parents[2]


def workspace_version() -> str:
    """The version in the `[workspace.package]` table of Cargo.toml (tomllib would need Python 3.11)."""
    table = (ROOT / "Cargo.toml").read_text().split("[workspace.package]")[1].split("\n[")[0]
    return re.search(r'^version = "([^"]+)"$', table, re.MULTILINE)[1]


def test_version_is_that_of_the_workspace():
    assert poecal.__version__ == workspace_version()
