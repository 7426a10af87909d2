"""Prints docs/commands.md, the reference of the program's commands, from the program's own help.

    python scripts/docs/commands.py target/release/poecal > docs/commands.md
"""

import os
import re
import subprocess
import sys

WIDTH = "80"
# Commands that `poecal --help` does not list.
NOT_LISTED = ["reproduce", "schema", "completions", "man"]


def page(program):
    overview = told(program)
    parts = [
        "# Commands\n\nWhat `poecal --help` and `poecal COMMAND --help` say, written by `scripts/docs/commands.py`. `poecal COMMAND -h` is shorter.\n",
        block(overview),
    ]
    parts += [f"## poecal {name}\n\n{block(told(program, name))}" for name in [*names(overview), *NOT_LISTED]]
    return "\n".join(parts)


def names(overview):
    """The commands that the program's help lists."""
    return [name for name in re.findall(r"^  ([a-z0-9-]+) ", overview, re.M) if name != "help"]


def block(text):
    return f"```text\n{text.rstrip()}\n```\n"


def told(program, *command):
    environment = {**os.environ, "COLUMNS": WIDTH, "NO_COLOR": "1"}
    run = subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=True, env=environment)
    return "\n".join(line.rstrip() for line in run.stdout.splitlines())


if __name__ == "__main__":
    sys.stdout.write(page(sys.argv[1]))
