"""Blocks of code in the documentation, and their execution as by a reader.

The kind of a block follows from its language and from an HTML comment right above it, which no reader sees:

    <!-- output -->               the block is what the commands before it print; … stands for anything
    <!-- file: NAME -->           the block is written into this file
    <!-- given: NAME = SOURCE --> before the commands, a file of the repository is copied to this name
    <!-- exit: CODE -->           the commands end with this code
    <!-- shorter: OLD = NEW -->   the commands are run with other words, which take less time
    <!-- not run: REASON -->      the block is left out, and counted as excused

Commands (`sh`) and programs (`python`) without such a comment are run, in the order of the page, in one folder a page.
"""

import contextlib
import io
import os
import re
import shutil
import subprocess
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path

from program import ROOT, program

FENCE = re.compile(r"^(?P<indent> *)```(?P<info>[^\n`]*)\n(?P<text>.*?)^(?P=indent)```$", re.M | re.S)
NOTES = re.compile(r"(?:<!-- *(?:output|(?:file|given|exit|shorter|not run):[^\n]*?) *-->\s*)+\Z")
NOTE = re.compile(r"<!-- *(?P<word>output|file|given|exit|shorter|not run)(?:: *(?P<value>.*?))? *-->")
# Figures with decimals and three digits or more, not parts of words, versions or powers of ten.
ROUNDED = re.compile(r"(?<![\w.-])((?=[\d.]{4,})\d+\.\d+)(?![\w.])")
# Languages that are not run: examples of text.
SHOWN = {"", "text", "math"}
# Files that are shown there are read by crates/poecal-results/tests/it/documented_files.rs.
DOCUMENTED_FILES = "docs/file-formats.md"


@dataclass
class Block:
    """A fenced block of a page."""

    language: str
    text: str
    line: int
    notes: dict[str, str] = field(default_factory=dict)
    given: list[tuple[str, str]] = field(default_factory=list)


@dataclass
class Counts:
    """Counts of the blocks of the pages by their treatment."""

    run: int = 0
    compared: int = 0
    written: int = 0
    shown: int = 0
    excused: list[str] = field(default_factory=list)


def blocks(page: Path) -> list[Block]:
    """The blocks of a page, in order."""
    text = page.read_text(encoding="utf-8")
    found = []
    for match in FENCE.finditer(text):
        before = text[: match.start()]
        notes = NOTES.search(before)
        pairs = [(note["word"], note["value"] or "") for note in NOTE.finditer(notes[0])] if notes else []
        lines = match["text"].splitlines()
        found.append(
            Block(
                language=re.split(r"[ ,]", match["info"])[0],
                text="".join(line.removeprefix(match["indent"]) + "\n" for line in lines),
                line=before.count("\n") + 1,
                notes={word: value for word, value in pairs if word != "given"},
                given=[tuple(value.split(" = ")) for word, value in pairs if word == "given"],
            )
        )
    return found


class Page:
    """A page that is being run in a folder."""

    def __init__(self, path: Path, folder: Path, counts: Counts):
        self.path, self.folder, self.counts = path, folder, counts
        self.printed = ""
        self.names: dict = {"__name__": "__main__"}
        tools = folder / ".tools"
        tools.mkdir()
        (tools / "poecal").symlink_to(Path(program()).resolve())
        # Pages name files from the repository's folder.
        (folder / "examples").symlink_to(ROOT / "examples")
        self.environment = {**os.environ, "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}", "NO_COLOR": "1", "LC_ALL": "C"}

    def run(self) -> None:
        for block in blocks(self.path):
            self.step(block)

    def step(self, block: Block) -> None:
        place = f"{self.path.relative_to(ROOT)}:{block.line}"
        if "not run" in block.notes:
            assert block.notes["not run"], f"{place}: a block is excused without a reason"
            self.counts.excused.append(f"{place}: {block.notes['not run']}")
        elif "output" in block.notes:
            found, expected = plain(self.printed), plain(block.text)
            assert matches(expected, found), f"{place}: shown is\n{expected}\nand printed was\n{found}"
            self.counts.compared += 1
        elif "file" in block.notes:
            path = self.folder / block.notes["file"]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
            self.counts.written += 1
        elif block.language == "sh":
            for name, source in block.given:
                shutil.copy(ROOT / source, self.folder / name)
            self.shell(block, place)
            self.counts.run += 1
        elif block.language == "python":
            self.python(block, place)
            self.counts.run += 1
        else:
            documented = SHOWN | {"toml", "xml"} if self.path == ROOT / DOCUMENTED_FILES else SHOWN
            assert block.language in documented, f"{place}: nobody runs `{block.language}`: say `not run`, and why"
            self.counts.shown += 1

    def shell(self, block: Block, place: str) -> None:
        # The program under test replaces the one that cargo would build.
        commands = block.text.replace("cargo run --release --", "poecal")
        if "shorter" in block.notes:
            old, new = block.notes["shorter"].split(" = ")
            assert old in commands, f"{place}: found no `{old}`"
            commands = commands.replace(old, new)
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", commands],
            cwd=self.folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        expected = int(block.notes.get("exit", 0))
        assert done.returncode == expected, f"{place}: ended with {done.returncode}\n{block.text}{done.stdout}"
        self.printed = done.stdout

    def python(self, block: Block, place: str) -> None:
        code = compile("\n" * block.line + block.text, str(self.path), "exec")
        out = io.StringIO()
        here = os.getcwd()
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(out):
                exec(code, self.names)
        except Exception as error:
            raise AssertionError(f"{place}: {type(error).__name__}: {error}") from error
        finally:
            os.chdir(here)
        self.printed = out.getvalue()


def plain(text: str) -> str:
    """A text without the parts that differ between machines: blanks at the ends of lines, and the last digits of rounding errors."""
    lines = (line.rstrip() for line in text.strip("\n").splitlines())
    return re.sub(r"\b\d(?:\.\d+)?e-1\d\b", "#", "\n".join(lines))


def matches(expected: str, found: str) -> bool:
    """True if a text is as shown, … matching anything within a line, or lines if it stands alone.

    A rounded figure of three digits or more may differ by one in its last: a sum in another order (another vector unit) is rounded differently.
    """
    pattern = ""
    for line in expected.splitlines():
        if line.strip() == "…":
            pattern += r"(?:[^\n]*\n)*?"
        else:
            pattern += r"[^\n]*".join(map(part_pattern, line.split("…"))) + r"\n"
    return re.fullmatch(pattern, found + "\n") is not None


def part_pattern(part: str) -> str:
    """A pattern of a part of a line: its words unchanged, its rounded figures to one in the last digit."""
    pieces = ROUNDED.split(part)
    return "".join(re.escape(piece) if k % 2 == 0 else rounded_pattern(piece) for k, piece in enumerate(pieces))


def rounded_pattern(figure: str) -> str:
    """A pattern of a figure and its two neighbours of as many decimals."""
    decimals = len(figure.partition(".")[2])
    unit = Decimal(1).scaleb(-decimals)
    return "(?:" + "|".join(re.escape(str(Decimal(figure) + k * unit)) for k in (-1, 0, 1)) + ")"
