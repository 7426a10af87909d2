"""Typical wrong usages of the program: one sentence, exit code 2 and nothing written; in both orders of their words, and beside a second mistake,
an output of another program. The first mistake is the one that is named.
"""

import shutil
import subprocess

import pytest
from program import ELBOW, program

MODEL, POINTS = "robot.urdf", "points.csv"
# The words beside --out, and the content of the sentence.
USAGES = {
    "arguments swapped": (["calibrate", POINTS, MODEL], "did you swap the arguments? The model comes first"),
    "no such model": (["calibrate", "robt.urdf", POINTS], "robt.urdf: found no such file, expected a robot model"),
    "no such measurements": (["calibrate", MODEL, "pionts.csv"], "pionts.csv: found no such file, expected a measurement file"),
    "a PDF as the model": (["calibrate", "robot.pdf", POINTS], "robot.pdf: found a PDF, expected a robot model"),
    "a URDF as the calibration": (["report", MODEL, "--certificate"], "robot.urdf: found a URDF, expected a calibration"),
    "no form": (["export", "calibration.json"], "expected --out NAME.urdf or NAME.toml, or --format with one of urdf, toml"),
    "the form of a controller": (["export", "calibration.json", "--format", "kuka"], "whose maker publishes no format for this (KUKA"),
    "no such mapping": (["calibrate", MODEL, POINTS, "--columns", "map.toml"], "map.toml: found no such file, expected a column mapping"),
    "a word of an option misspelt": (["calibrate", MODEL, POINTS, "--device-frame", "bose"], "bose"),
    "no such link": (["calibrate", MODEL, POINTS, "--tip-link", "flange"], "flange"),
}


@pytest.fixture
def folder(tmp_path):
    shutil.copy(ELBOW, tmp_path)
    shutil.copy(ELBOW.parent / POINTS, tmp_path)
    (tmp_path / "robot.pdf").write_bytes(b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n")
    subprocess.run([program(), "calibrate", MODEL, POINTS, "--out", "own", "--quiet"], cwd=tmp_path, check=True)
    shutil.copy(tmp_path / "own/calibration.json", tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/notes.txt").write_text("not of poecal")
    return tmp_path


def listing(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize("name", USAGES)
def test_a_wrong_usage_is_one_sentence_in_both_orders(name, folder):
    (command, *words), expected = USAGES[name]
    before = listing(folder)
    for out in ["new", "mine"]:
        said = []
        for order in [[*words, "--out", out], ["--out", out, *words]]:
            done = subprocess.run([program(), command, *order], cwd=folder, capture_output=True, text=True, check=False)
            print(done.stderr)
            assert done.returncode == 2 and done.stdout == "", (order, done)
            assert done.stderr.startswith("error: ") and expected in done.stderr, (order, done.stderr)
            said.append(done.stderr)
        assert said[0] == said[1], name
    assert listing(folder) == before
