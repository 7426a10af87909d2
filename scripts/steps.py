"""Steps of ./test: commands that need each other, run as many at once as there are processors, with their times."""

import dataclasses
import os
import re
import shlex
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SLOWEST = 10
# Processors that this process may use: a container may have some of a machine's.
PROCESSORS = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
# Last lines of a step that failed, at the end; its whole output is above.
LAST_LINES = 40


@dataclasses.dataclass
class Step:
    """One step: commands, one after the other, up to the first that fails."""

    name: str
    commands: list[list[str]]
    # Names of steps that must have passed.
    after: list[str] = dataclasses.field(default_factory=list)
    # Lines of its output that the summary shows.
    shows: str = "(?!)"
    # The tool that it needs and that is missing here. With CI=true, where everything has to be present, the step has failed then.
    lacks: str | None = None
    # A missing tool that no other step brings: the step is left out, also with CI=true.
    may_lack: bool = False
    # True if it waits more than it works, as a browser does: it begins beside as many working steps as there are processors, one such at a time.
    waits: bool = False
    # Variables of its own.
    env: dict[str, str] = dataclasses.field(default_factory=dict)


class Run:
    """All steps: each begins when those that it needs have passed and there is room for it, in the order of the list."""

    def __init__(self, steps: list[Step]):
        for at, step in enumerate(steps):
            unknown = set(step.after) - {earlier.name for earlier in steps[:at]}
            assert not unknown, f"{step.name} is listed before {unknown}, which it needs"
        self.steps = steps
        self.state = {step.name: "waiting" for step in steps}
        self.seconds: dict[str, float] = {}
        self.output: dict[str, str] = {}
        self.shown: dict[str, list[str]] = {}
        self.changed = threading.Condition()
        self.is_stopping = False
        self.children: set[subprocess.Popen[str]] = set()
        self.start = time.monotonic()

    def ready(self) -> Step | None:
        """The next step that can begin; ends steps that cannot."""
        for step in self.steps:
            if self.state[step.name] != "waiting":
                continue
            needed = [self.state[name] for name in step.after]
            if any(state in ("failed", "skipped") for state in needed):
                missing = next(name for name, state in zip(step.after, needed, strict=True) if state in ("failed", "skipped"))
                self.end(step, "skipped", f"skipped, it needs `{missing}`")
            elif step.lacks:
                is_failure = os.environ.get("CI") == "true" and not step.may_lack
                self.end(step, "failed" if is_failure else "skipped", f"{'FAILED' if is_failure else 'skipped'}, found no {step.lacks}")
            elif all(state == "passed" for state in needed) and self.has_room(step):
                return step
        return None

    def has_room(self, step: Step) -> bool:
        """True if a processor is free, or, for a step that waits, no other one runs."""
        same = sum(self.state[other.name] == "running" for other in self.steps if other.waits == step.waits)
        return same < (1 if step.waits else max(2, PROCESSORS))

    def end(self, step: Step, state: str, words: str) -> None:
        self.state[step.name] = state
        self.shown[step.name] = [f"{step.name}: {words}"]
        print(f"\n=== {step.name}: {words}", flush=True)

    def work(self) -> None:
        while True:
            with self.changed:
                step = self.ready()
                while step is None:
                    if "waiting" not in self.state.values():
                        self.changed.notify_all()
                        return
                    if "running" not in self.state.values():
                        raise RuntimeError("steps need each other")
                    self.changed.wait()
                    step = self.ready()
                self.state[step.name] = "running"
            try:
                print(f"[{self.clock()}] {step.name}: begun", flush=True)
                self.carry_out(step)
            except Exception as error:  # noqa: BLE001: whatever happens here, the step has failed, and others wait for it.
                with self.changed:
                    self.state[step.name], self.seconds[step.name] = "failed", 0.0
                    self.output[step.name] = f"{type(error).__name__}: {error}"
                    self.shown[step.name] = [f"{step.name}: FAILED ({self.output[step.name]})"]
            with self.changed:
                self.changed.notify_all()

    def clock(self) -> str:
        seconds = round(time.monotonic() - self.start)
        return f"{seconds // 60:2d}:{seconds % 60:02d}"

    def carry_out(self, step: Step) -> None:
        begin, processor, output, complaint = time.monotonic(), 0.0, [], None
        for command in step.commands:
            output.append(f"$ {shlex.join(command)}\n")
            with self.changed:
                if self.is_stopping:
                    return
                # With a process group of its own, which ends with this one.
                child = subprocess.Popen(
                    command, cwd=ROOT, env={**os.environ, **step.env}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True,
                )  # fmt: skip
                self.children.add(child)
            said = child.stdout.read() if child.stdout else ""
            # With the time of its own children.
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            with self.changed:
                self.children.discard(child)
            processor += usage.ru_utime + usage.ru_stime
            output.append(said)
            complaint = f"exit code {child.returncode}" if child.returncode else None
            if complaint:
                break
        text = "".join(output)
        seconds = time.monotonic() - begin
        with self.changed:
            self.seconds[step.name], self.output[step.name] = seconds, text
            self.state[step.name] = "failed" if complaint else "passed"
            words = f"FAILED ({complaint})" if complaint else "ok"
            words += f", {seconds:.1f} s, {processor:.1f} s of processors"
            self.shown[step.name] = [f"{step.name}: {words}"]
            self.shown[step.name] += [f"    {line}" for line in text.splitlines() if re.search(step.shows, line)]
            print(f"\n=== {step.name}: {words}\n{text}\n[{self.clock()}] {step.name}: {words}", flush=True)

    def stop(self) -> None:
        """Ends running steps; nothing begins after it."""
        with self.changed:
            self.is_stopping, children = True, list(self.children)
        for child in children:
            try:
                os.killpg(child.pid, signal.SIGKILL)
            except ProcessLookupError:
                continue

    def whole(self) -> int:
        """Runs everything; returns the exit code."""
        for number in (signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda number, _: sys.exit(128 + number))
        try:
            threads = [threading.Thread(target=self.work, daemon=True) for _ in range(max(2, PROCESSORS) + 1)]
            for thread in threads:
                thread.start()
            for thread in threads:
                while thread.is_alive():
                    thread.join(1)
        finally:
            self.stop()
        failed = [step.name for step in self.steps if self.state[step.name] == "failed"]
        for name in failed:
            last = "\n".join(self.output.get(name, self.shown[name][0]).rstrip().splitlines()[-LAST_LINES:])
            print(f"\n=== FAILED: {name}\n{last}")
        print("\n=== summary")
        for step in self.steps:
            print("\n".join(self.shown[step.name]))
        print("\nslowest steps")
        for name, seconds in sorted(self.seconds.items(), key=lambda item: -item[1])[:SLOWEST]:
            print(f"{seconds:7.1f} s  {name}")
        whole = f"{(time.monotonic() - self.start) / 60:.1f} minutes"
        print(f"\nFAILED: {', '.join(failed)} ({whole})" if failed else f"\nall passed ({whole})", flush=True)
        return 1 if failed else 0
