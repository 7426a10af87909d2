"""Files of the program for a shell: completions and manual pages."""

import os
import re
import shutil
import subprocess
import sys

import pytest
from program import ROOT, poecal, program

sys.path.insert(0, str(ROOT / "scripts/docs"))
from commands import names  # noqa: E402

SHELLS = ["bash", "elvish", "fish", "powershell", "zsh"]
COMMANDS = names(poecal("--help"))


@pytest.mark.parametrize("shell", SHELLS)
def test_completions_name_every_command_and_are_read_by_their_shell(shell, tmp_path):
    script = tmp_path / "completions"
    script.write_text(poecal("completions", shell))
    text = script.read_text()
    assert all(name in text for name in COMMANDS) and "sigma-position" in text
    if shell in ("bash", "fish", "zsh") and shutil.which(shell):
        read = subprocess.run([shell, "-n", script], capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
        assert (read.returncode, read.stderr) == (0, "")


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        (["cal"], ["calibrate"]),
        (["calibrate", "--sig"], ["--sigma-position", "--sigma-rotation"]),
        (["calibrate", "--robust", "t"], ["tukey"]),
    ],
)
def test_bash_completes(typed, completed, tmp_path):
    script = tmp_path / "completions"
    script.write_text(poecal("completions", "bash"))
    words = " ".join(["poecal", *typed])
    before = (["poecal", *typed])[-2]
    commands = f"""
        source {script}
        COMP_WORDS=({words}); COMP_CWORD={len(typed)}
        _poecal poecal {typed[-1]} {before}
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    done = subprocess.run(["bash", "-c", commands], capture_output=True, text=True)
    assert (done.stdout.split(), done.returncode) == (completed, 0), done.stderr


@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_the_manual_page_has_every_option(command, tmp_path):
    page = tmp_path / "page.1"
    page.write_text(poecal("man", *filter(None, [command])))
    text = page.read_text()
    assert f'.TH poecal{f"-{command}" if command else ""} 1' in text
    assert f'"{poecal("--version").strip()}"' in text.splitlines()[2]
    help_text = poecal(*filter(None, [command]), "--help")
    options = set(re.findall(r"^ +(?:-\w, )?--([a-z0-9-]+)", help_text, re.M))
    assert options >= {"help", "quiet"}
    plain = text.replace("\\-", "-")
    assert [name for name in options if f"--{name}" not in plain] == []
    if groff := shutil.which("groff"):
        read = subprocess.run([groff, "-man", "-Tutf8", "-ww", "-z", page], capture_output=True, text=True)
        assert (read.returncode, read.stderr) == (0, "")


def test_an_unknown_command_has_no_manual_page():
    done = subprocess.run([program(), "man", "calibrat"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("error: man: found no command `calibrat`, expected one of init, calibrate, ")
    assert done.stderr.endswith("; did you mean `calibrate`?\n")
