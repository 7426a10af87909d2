"""The program ``poecal``, as the wheel installs it; also ``python -m poecal``."""

import signal
import sys

from ._poecal import run_program


def main() -> None:
    """Runs the program with the arguments of this process, and ends with its exit code."""
    # Ctrl-C ends the program at once, as it ends any other. The program reports a pipe whose reader goes away: Python, like Rust, ignores the signal.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(run_program(["poecal", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
