"""Bags of ROS 2 in SQLite (``.db3``), written as MCAP in memory, which the library reads."""

import hashlib
import re
import sqlite3
import struct
import urllib.parse
from collections.abc import Iterator
from pathlib import Path

MAGIC = b"SQLite format 3\x00"
MCAP = b"\x89MCAP0\r\n"
ZSTD = b"\x28\xb5\x2f\xfd"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, DATA_END = 1, 2, 3, 4, 5, 15
EXPECTED = "expected a ROS 2 bag in SQLite, with the tables `topics` and `messages`"
CONVERT = "`rosbags-convert --src BAG --dst NEW --dst-storage mcap` writes it as MCAP"
# Types whose messages are read; of others only their number and times count.
TYPES = {
    "sensor_msgs/JointState",
    "geometry_msgs/PoseStamped",
    "geometry_msgs/PointStamped",
    "geometry_msgs/TransformStamped",
    "tf2_msgs/TFMessage",
}


class NotRead(ValueError):
    """A bag that is not read, with the reason; the file comes with it."""

    def __init__(self, path: Path, message: str) -> None:
        super().__init__(str(path), message)


def parts(path: str | Path) -> list[Path]:
    """The files of a bag in SQLite by their numbers, one or those of a folder; empty for anything else."""
    path = Path(path)
    if path.is_dir():
        names = sorted(path.glob("*.db3"), key=lambda it: (int((re.findall(r"\d+", it.stem) or ["0"])[-1]), it.name))
        return [] if any(path.glob("*.mcap")) else names
    try:
        with path.open("rb") as file:
            return [path] if file.read(len(MAGIC)) == MAGIC else []
    except OSError:
        return []


def text(value: str) -> bytes:
    """A text in the form of MCAP."""
    encoded = value.encode()
    return struct.pack("<I", len(encoded)) + encoded


def record(kind: int, content: bytes) -> bytes:
    """A record of MCAP."""
    return struct.pack("<BQ", kind, len(content)) + content


def connected(path: Path) -> sqlite3.Connection:
    """The database, opened for reading only."""
    name = urllib.parse.quote(str(path.resolve()).replace("\\", "/"), safe="/:")
    return sqlite3.connect(f"file:{'' if name.startswith('/') else '/'}{name}?mode=ro", uri=True)


def records_of(path: Path, channels: dict[tuple[str, str, str], int]) -> Iterator[bytes]:
    """Records of a file: of each topic type and channel once, then its messages in the order of the log."""
    database = connected(path)
    try:
        own = {}
        for number, name, kind, form in database.execute("SELECT id, name, type, serialization_format FROM topics"):
            channel = channels.get((name, kind, form))
            if channel is None:
                channel = channels[name, kind, form] = len(channels) + 1
                yield record(SCHEMA, struct.pack("<H", channel) + text(kind) + text("ros2msg") + struct.pack("<I", 0))
                # The library knows no other form of messages than CDR.
                yield record(CHANNEL, struct.pack("<HH", channel, channel) + text(name) + text(form) + struct.pack("<I", 0))
            own[number] = (channel, kind.replace("/msg/", "/") in TYPES)
        for number, at, data in database.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id"):
            channel, is_read = own.get(number, (0, False))
            if is_read and bytes(data[:4]) == ZSTD:
                raise NotRead(path, f"found messages that are compressed one by one, expected plain ones: {CONVERT}")
            content = struct.pack("<HIQQ", channel, 0, max(at, 0), max(at, 0))
            yield record(MESSAGE, content + (bytes(data) if is_read else b""))
    finally:
        database.close()


def as_mcap(path: str | Path) -> tuple[bytes, str] | None:
    """The bytes of a bag as MCAP, and the checksum of its files; None for a file that is no bag in SQLite."""
    files = parts(path)
    if not files:
        return None
    out = [MCAP, record(HEADER, text("ros2") + text("poecal"))]
    channels: dict[tuple[str, str, str], int] = {}
    checksum = hashlib.sha256()
    for file in files:
        try:
            with file.open("rb") as opened:
                while block := opened.read(1 << 20):
                    checksum.update(block)
            out.extend(records_of(file, channels))
        except sqlite3.Error as error:
            raise NotRead(file, f"found a database that cannot be read ({error}), {EXPECTED}") from None
        except (TypeError, UnicodeError, struct.error) as error:
            raise NotRead(file, f"found a table of another kind ({error}), {EXPECTED}") from None
        except OSError as error:
            raise NotRead(file, f"found a file that cannot be read ({error.strerror}), {EXPECTED}") from None
    out += [record(DATA_END, struct.pack("<I", 0)), record(FOOTER, struct.pack("<QQI", 0, 0, 0)), MCAP]
    return b"".join(out), checksum.hexdigest()
