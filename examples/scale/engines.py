"""One function over many items, in this process, by Ray or by Dask: rows come in the order of the items, whoever computed them.

A row depends on its item alone. If a process ends, Ray and Dask compute what it had again, by another one, and the bytes are the same. Both
start processes on this machine, or use the cluster at an address, whose machines have the package `poecal` and see the same files.
"""

import argparse
import csv
import json
import logging
import os
import secrets
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

# What a task gives: numbers and texts by name.
Row = dict[str, Any]
Work = Callable[[Any], Row]

# What waits between processes is some kilobytes an item: nearly the least that Ray accepts.
STORE_BYTES = 100_000_000
# Tasks of Ray for each processor.
BLOCKS = 16


def count(word: str) -> int:
    """A number of things, of at least one."""
    if not word.isascii() or not word.isdigit() or int(word) < 1:
        raise argparse.ArgumentTypeError(f"found `{word}`, expected a whole number from 1")
    return int(word)


def add_options(parser: argparse.ArgumentParser) -> None:
    """How to run: the same of every example."""
    parser.add_argument("--engine", choices=ENGINES, default="none", help="what runs the tasks (default: this process)")
    parser.add_argument("--workers", type=count, default=os.cpu_count() or 1, help="processes to start (default: one a processor)")
    parser.add_argument("--address", help="a cluster that is there already, as Ray or Dask names it, instead of processes to start")
    parser.add_argument("--kill-one", action="store_true", help="kill a process half way, to see that the results stay the same")


def options_of(parser: argparse.ArgumentParser) -> argparse.Namespace:
    """The options as they were typed; refuses what does not fit together."""
    options = parser.parse_args()
    if options.kill_one and (options.engine == "none" or options.address):
        parser.error("--kill-one: found no process of its own to kill, expected --engine ray or dask without --address")
    return options


def run(work: Work, items: Sequence[Any], options: argparse.Namespace) -> list[Row]:
    """The row of each item, in their order."""
    # A task takes one processor. Processes that are started have this from here.
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    with tempfile.TemporaryDirectory(prefix="scale-", ignore_cleanup_errors=True) as folder:
        mark = Path(folder) / "killed"
        if options.kill_one:
            work = Deadly(work, items[len(items) // 2], mark)
        rows = ENGINES[options.engine](work, items, options, folder)
        if options.kill_one:
            print(f"process {mark.read_text()} was killed on the way", file=sys.stderr)
    return rows


def by_none(work: Work, items: Sequence[Any], options: argparse.Namespace, folder: str) -> list[Row]:
    """One item after the other, in this process."""
    return [work(item) for item in items]


def by_ray(work: Work, items: Sequence[Any], options: argparse.Namespace, folder: str) -> list[Row]:
    """Tasks of Ray Data, which asks the network for nothing."""
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    if not options.address:
        # Keeps to 127.0.0.1, on Linux too, and to those who know the word.
        os.environ |= {"RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0", "RAY_AUTH_MODE": "token", "RAY_AUTH_TOKEN": secrets.token_hex(32)}
    import ray

    def batch(columns: Any) -> Any:
        rows = [json.dumps(work(json.loads(item))) for item in columns["item"]]
        return {"index": columns["index"], "row": rows}

    alone = {"num_cpus": options.workers, "object_store_memory": STORE_BYTES, "include_dashboard": False}
    alone |= {"_node_ip_address": "127.0.0.1", "_temp_dir": folder}
    ray.init(**({"address": options.address} if options.address else alone), logging_level=logging.WARNING, log_to_driver=False)
    try:
        ray.data.DataContext.get_current().enable_progress_bars = False
        logging.getLogger("ray.data").setLevel(logging.ERROR)
        columns = [{"index": index, "item": json.dumps(item)} for index, item in enumerate(items)]
        # A block is a task, which takes some hundredths of a second to start, and is done again as a whole; a batch is an item.
        blocks = min(len(columns), BLOCKS * int(ray.cluster_resources()["CPU"]))
        rows = ray.data.from_items(columns, override_num_blocks=blocks).map_batches(batch, batch_size=1).take_all()
    finally:
        ray.shutdown()
    return [json.loads(row["row"]) for row in sorted(rows, key=lambda row: row["index"])]


def by_dask(work: Work, items: Sequence[Any], options: argparse.Namespace, folder: str) -> list[Row]:
    """Futures of Dask."""
    from dask.distributed import Client, LocalCluster

    alone = {"n_workers": options.workers, "threads_per_worker": 1, "host": "127.0.0.1", "dashboard_address": None}
    alone |= {"local_directory": folder, "silence_logs": logging.ERROR}
    with nullcontext(options.address) if options.address else LocalCluster(**alone) as cluster, Client(cluster) as client:
        rows: list[Row] = client.gather(client.map(work, items, pure=False))
    return rows


ENGINES = {"none": by_none, "ray": by_ray, "dask": by_dask}


class Deadly:
    """Work that once, at one item, kills its process while it is busy. Only on one machine, whose processes see the same file."""

    def __init__(self, work: Work, item: Any, mark: Path) -> None:
        self.work, self.item, self.mark = work, item, mark

    def __call__(self, item: Any) -> Row:
        if item == self.item and not self.mark.exists():
            self.mark.write_text(str(os.getpid()))
            threading.Timer(0.02, os.kill, (os.getpid(), signal.SIGKILL)).start()
        return self.work(item)


def write(path: Path, rows: Sequence[Row]) -> None:
    """Writes rows as a CSV, every number as it reads back exactly; puts the file in place as a whole."""
    new = path.with_suffix(".new")
    with new.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    new.replace(path)
