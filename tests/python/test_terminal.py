"""The program on a terminal of 80 columns: readable lines, colours and a progress bar; and none of these elsewhere."""

import os
import re
import shutil
import subprocess
import sys

import pytest
from program import ELBOW, ROOT, program

if sys.platform == "win32":
    pytest.skip("a pseudo-terminal is tested on POSIX systems", allow_module_level=True)

import fcntl
import pty
import struct
import termios

ESCAPE = re.compile(r"\x1b\[[0-9;?]*[a-zA-Z]")
COLOUR = re.compile(r"\x1b\[[0-9;]*m")
WIDTH = 80


def on_terminal(folder, *arguments, width=WIDTH, **environment):
    """Output of a run on a terminal, and its exit code."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, width, 0, 0))
    clean = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "COLUMNS", "CLICOLOR_FORCE", "CI")}
    run = subprocess.Popen(
        [program(), *map(str, arguments)],
        cwd=folder,
        env={**clean, "TERM": "xterm-256color", **environment},
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
    )
    os.close(theirs)
    shown = b""
    try:
        while part := os.read(ours, 65536):
            shown += part
    except OSError:
        # Linux reports a closed other side by this error.
        pass
    os.close(ours)
    return shown.decode(), run.wait()


def lines(shown):
    """Final lines, without colours: overwritten text, as a progress bar is, counts each time."""
    return [line for part in ESCAPE.sub("", shown).split("\n") for line in part.split("\r")]


def in_pipe(folder, *arguments, **environment):
    environment = {**os.environ, "TERM": "xterm-256color", **environment}
    run = subprocess.run([program(), *map(str, arguments)], cwd=folder, env=environment, capture_output=True, text=True)
    return run.stdout, run.stderr


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """A folder with a session, a calibration of it, and the same with a wrong row, with a joint that did not move, and swapped."""
    folder = tmp_path_factory.mktemp("terminal")
    shutil.copy(ELBOW, folder / "robot.urdf")
    for words in [
        "simulate robot.urdf --kind point --count 60 --held-out-count 40 --out lesson",
        "calibrate robot.urdf lesson/measurements.csv --out result",
    ]:
        in_pipe(folder, *words.split())
    head, names, *rows = (folder / "lesson/measurements.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows]

    def write(name, table):
        (folder / name).write_text("\n".join([head, names, *(",".join(row) for row in table)]) + "\n")

    write("knocked.csv", [row[:6] + [str(float(row[6]) + 40)] + row[7:] if k in (3, 30) else row for k, row in enumerate(cells)])
    write("still.csv", [row[:3] + ["10"] + row[4:] for row in cells])
    write("swapped.csv", [[row[0], row[2], row[1], *row[3:]] for row in cells])
    return folder


COMMANDS = [
    "calibrate robot.urdf lesson/measurements.csv --force",
    "calibrate robot.urdf knocked.csv --force",
    "calibrate robot.urdf swapped.csv --force",
    "validate result/calibration.json lesson/held_out.csv",
    "validate result/calibration.json knocked.csv",
    "plan robot.urdf --rows lesson/measurements.csv --kind pose",
    "plan robot.urdf --rows still.csv --kind point",
    "check robot.urdf lesson/measurements.csv",
    "check robot.urdf swapped.csv",
    "offsets robot.urdf result/calibration.json",
    "report result/calibration.json",
    "simulate robot.urdf --out lesson --held-out-count 40 --kind point --count 60 --force",
    "reproduce breakdown --trials 1 --out breakdown --force",
    "init robot.urdf --kind smells",
    "calibrate robot.urdf nothing_of_this_name.csv --out elsewhere",
    "predict robot.urdf still.csv --target nothing_of_this_name",
    "calibrate robot.urdf knocked.csv --force --verbose",
    "calibrate --help",
    "--help",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_no_line_is_wider_than_the_terminal(session, command):
    shown, _ = on_terminal(session, *command.split())
    wide = [line for line in lines(shown) if len(line) > WIDTH]
    assert not wide, wide
    assert len(shown) > 20


@pytest.mark.parametrize("command", COMMANDS)
def test_a_narrow_terminal_is_survived(session, command):
    shown, code = on_terminal(session, *command.split(), width=60)
    assert code in (0, 1, 2) and "panicked" not in shown
    # Tables keep their columns; sentences keep to the width.
    sentences = [line for line in lines(shown) if re.match(r"warning:|error:|noise |solver |verdict |look at |determined | {14}\S", line)]
    assert all(len(line) <= 60 or re.search(r"\S {2,}\S", line[14:]) for line in sentences), sentences


@pytest.mark.parametrize("command", COMMANDS[:11] + ["init robot.urdf --kind smells", "calibrate --help"])
def test_colours_are_for_terminals_only(session, command):
    words = command.split()
    assert COLOUR.search(on_terminal(session, *words)[0])
    for environment in [{"NO_COLOR": "1"}, {"TERM": "dumb"}]:
        shown = on_terminal(session, *words, **environment)[0]
        assert not COLOUR.search(shown), environment
    out, err = in_pipe(session, *words)
    assert "\x1b" not in out + err


def test_a_pipe_gets_the_same_words_and_messages_in_one_line(session):
    words = COMMANDS[4].split()
    out, err = in_pipe(session, *words)
    assert err.startswith("warning: ") and err.count("\n") == 1
    shown = ESCAPE.sub("", on_terminal(session, *words)[0]).replace("\r\n", "\n")
    assert out in shown
    assert " ".join(err.split()) in " ".join(shown.split())


def test_the_verdict_has_the_colour_of_what_it_says(session):
    shown = on_terminal(session, *COMMANDS[0].split())[0]
    assert "\x1b[1m\x1b[32mgood\x1b[0m" in shown
    shown = on_terminal(session, *COMMANDS[2].split())[0]
    assert "\x1b[1m\x1b[31mdo not use\x1b[0m" in shown


def test_progress_is_drawn_on_terminals_that_can_draw(session):
    # A bar needs a fit that takes longer than a moment.
    in_pipe(session, *"simulate robot.urdf --count 5000 --out many".split())
    words = "calibrate robot.urdf many/measurements.csv --report none --out large --force".split()
    assert "█" in on_terminal(session, *words)[0]
    assert "█" not in on_terminal(session, *words, TERM="dumb")[0]
    assert "█" not in on_terminal(session, *words, "--quiet")[0]
    assert "█" not in "".join(in_pipe(session, *words))


def test_data_have_no_colours(session):
    for command in ["predict robot.urdf still.csv", "check robot.urdf --json", "export robot.urdf --format toml --quiet", "schema"]:
        shown, code = on_terminal(session, *command.split())
        assert code == 0 and not COLOUR.search(shown), command
    assert (ROOT / "docs/calibration.schema.json").read_text() == on_terminal(session, "schema")[0].replace("\r\n", "\n")
