"""The same bytes have the same result, by path, as standard input or through a pipe, alone and beside another file."""

import os
import re
import subprocess
import threading
from pathlib import Path

import pytest
from program import ELBOW, ROOT, program

HOWTO = ROOT / "examples/howto"
SEEDS = [path for kind in ("measurements", "recorded", "messages") for path in sorted((ROOT / "fuzz/seeds" / kind).iterdir())]
EXAMPLES = [path for folder in (HOWTO, ROOT / "examples/elbow") for path in sorted(folder.iterdir()) if path.is_file()]


def answer(*arguments, named=(), **options) -> tuple[int, str]:
    """Exit code and whole output, without names of files and ends of lines."""
    run = subprocess.run([program(), *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)
    said = run.stdout + run.stderr
    for name in named:
        said = said.replace(str(name), "FILE")
    return run.returncode, re.sub(r"(?<![\w./])-(?=[:\s])", "FILE", re.sub(r"\s+", " ", said))


def through_pipe(content: bytes, use):
    """Result of `use` for the path of a pipe with this content."""
    out, into = os.pipe()

    def write():
        with os.fdopen(into, "wb") as end:
            try:
                end.write(content)
            except BrokenPipeError:
                pass

    writer = threading.Thread(target=write)
    writer.start()
    try:
        return use(Path(f"/dev/fd/{out}"), out)
    finally:
        os.close(out)
        writer.join()


@pytest.mark.skipif(not Path("/dev/fd").exists(), reason="pipes have no paths here")
@pytest.mark.parametrize("path", SEEDS + EXAMPLES, ids=lambda path: f"{path.parent.name}-{path.name}")
def test_a_file_alone(path):
    expected = answer("check", ELBOW, path, named=[path])
    with path.open("rb") as content:
        assert answer("check", ELBOW, "-", named=[path], stdin=content) == expected
    # The name alone may show that a file is of another kind.
    if path.suffix in (".py", ".md"):
        return
    found = through_pipe(path.read_bytes(), lambda pipe, end: answer("check", ELBOW, pipe, named=[pipe], pass_fds=[end]))
    assert found == expected


@pytest.mark.skipif(not Path("/dev/fd").exists(), reason="pipes have no paths here")
@pytest.mark.parametrize("names", [("joints.csv", "take.csv"), ("moving_joints.csv", "moving_take.csv"), ("joints.xlsx", "points.txt")])
def test_two_files_are_joined_however_they_come(names):
    paths = [HOWTO / name for name in names]
    more = ["--join", "motion"] if "moving" in names[0] else []
    expected = answer("check", ELBOW, *paths, *more, named=paths)
    assert expected[0] == 0
    for at, path in enumerate(paths):
        given = [*paths[:at], "-", *paths[at + 1 :]]
        with path.open("rb") as content:
            assert answer("check", ELBOW, *given, *more, named=paths, stdin=content) == expected

        def use(pipe, end, at=at):
            given = [*paths[:at], pipe, *paths[at + 1 :]]
            return answer("check", ELBOW, *given, *more, named=[*paths, pipe], pass_fds=[end])

        assert through_pipe(path.read_bytes(), use) == expected


def test_a_shifted_header_is_refused_however_it_comes(tmp_path):
    header, *rows = [line for line in (ROOT / "examples/elbow/points.csv").read_text().splitlines() if not line.startswith("#")]
    shifted = tmp_path / "shift.csv"
    shifted.write_text("\n".join([f"{header},remark", *(f"{at * 0.125:.3f},{row}" for at, row in enumerate(rows))]) + "\n")
    expected = answer("check", ELBOW, shifted, named=[shifted])
    assert expected[0] == 2 and "one column further to the right" in expected[1]
    with shifted.open("rb") as content:
        assert answer("check", ELBOW, "-", stdin=content) == expected


def test_joint_readings_are_predicted_however_they_come(tmp_path):
    header, *rows = [line.split(",")[:6] for line in (ROOT / "examples/elbow/points.csv").read_text().splitlines() if not line.startswith("#")]
    table = tmp_path / "joints.csv"
    table.write_text("# comment\n" + "\n".join(",".join(row) for row in [header, *rows]) + "\n")
    expected = answer("predict", ELBOW, table, named=[table])
    assert expected[0] == 0
    with table.open("rb") as content:
        assert answer("predict", ELBOW, "-", stdin=content) == expected
    found = through_pipe(table.read_bytes(), lambda pipe, end: answer("predict", ELBOW, pipe, named=[pipe], pass_fds=[end]))
    assert found == expected


TITLED = [
    ("a key as title", "Robot: KR16\n", "{}"),
    ("blanks before each line", "Project: cell 4\n", "  {}"),
    ("many keys as titles", "".join(f"Key{number}: value\n" for number in range(30)), "{}"),
]


@pytest.mark.parametrize(("title", "row"), [it[1:] for it in TITLED], ids=[it[0] for it in TITLED])
def test_a_table_below_titles_is_no_yaml(title, row, tmp_path):
    lines = [line for line in (ROOT / "examples/elbow/points.csv").read_text().splitlines() if not line.startswith("#")]
    table = tmp_path / "titled.csv"
    table.write_text(title + "\n".join(row.format(line) for line in lines) + "\n")
    said = answer("check", ELBOW, table)[1]
    assert "YAML" not in said, said


def test_columns_of_a_maker_have_its_units_in_every_command(tmp_path):
    _, *rows = [line for line in (ROOT / "examples/elbow/points.csv").read_text().splitlines() if not line.startswith("#")]
    joints = ",".join(f"joint{number}[deg]" for number in range(1, 7))
    table = tmp_path / "abc.csv"
    table.write_text("\n".join([f"{joints},X,Y,Z,A,B,C", *(f"{row},10,20,30" for row in rows)]) + "\n")
    code, said = answer("check", ELBOW, table)
    assert code == 0 and "took the columns A, B, C for KUKA's A, B, C, in mm and deg" in said, said
    assert "100 poses" in said, said
