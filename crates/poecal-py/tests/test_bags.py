"""Bags of ROS 2 in SQLite (.db3), which the package reads by itself: they are made here as rosbag2 makes them."""

import pickle
import sqlite3
import struct

import numpy as np
import poecal
import pytest
from robots import configurations, elbow

FIRST_NS = 1_700_000_000_400_000_000
LAG_NS = 137_500_000
STAND, MOVED, STANDS = 50, 40, 14  # hundredths of a second


class Cdr:
    """A message of ROS 2: values aligned from behind the head."""

    def __init__(self, stamp_ns: int, frame: str):
        self.bytes = bytearray()
        self.put("i", stamp_ns // 10**9).put("I", stamp_ns % 10**9).text(frame)

    def put(self, form: str, value) -> "Cdr":
        self.bytes += bytes(-len(self.bytes) % struct.calcsize(form)) + struct.pack("<" + form, value)
        return self

    def text(self, value: str) -> "Cdr":
        self.put("I", len(value) + 1)
        self.bytes += value.encode() + b"\0"
        return self

    def numbers(self, values) -> "Cdr":
        for value in values:
            self.put("d", value)
        return self

    def message(self) -> bytes:
        return b"\x00\x01\x00\x00" + bytes(self.bytes)


def joint_state(stamp_ns: int, names, values) -> bytes:
    message = Cdr(stamp_ns, "").put("I", len(names))
    for name in names:
        message.text(name)
    return message.put("I", len(values)).numbers(values).put("I", 0).put("I", 0).message()


def point(stamp_ns: int, place) -> bytes:
    return Cdr(stamp_ns, "tracker").numbers(place).message()


def motion(count: int):
    """Configurations each hundredth of a second: static intervals, and moves between them."""
    stands = 0.5 * configurations(count, seed=3)
    rows = []
    for here, there in zip(stands, [*stands[1:], stands[-1]], strict=True):
        rows += [here] * STAND
        rows += [here + (there - here) * share for share in np.arange(MOVED) / MOVED]
    return np.array(rows)


def messages(robot):
    """Messages by their topics and times in the log, and the same as tables."""
    rows = motion(STANDS)
    noise = np.random.default_rng(5).normal(0, 2e-5, (len(rows), 3))
    places = robot.forward_kinematics(rows)[:, :3, 3] + noise
    found, joints, seen = [], [], []
    for at, (row, place) in enumerate(zip(rows, places, strict=True)):
        stamp = FIRST_NS + at * 10_000_000
        if at % 2 == 0:
            names = [*reversed(robot.reading_names), "gripper"]
            found.append(("/joint_states", stamp + 900_000, joint_state(stamp, names, [*reversed(row), 0.01])))
            joints.append([(stamp - FIRST_NS) / 1e9, *row])
        found.append(("/tracker/point", stamp + LAG_NS + 700_000, point(stamp + LAG_NS, place)))
        seen.append([(stamp + LAG_NS - FIRST_NS) / 1e9, *place])
    return found, joints, seen


TYPES = {"/joint_states": "sensor_msgs/msg/JointState", "/tracker/point": "geometry_msgs/msg/PointStamped", "/chatter": "std_msgs/msg/String"}


def write_db3(path, all_messages) -> None:
    """As rosbag2 writes it."""
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)")
        database.execute(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL, "
            "offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL)"
        )
        database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
        numbers = {name: number for number, name in enumerate(TYPES, 1)}
        for name, number in numbers.items():
            database.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '', '')", (number, name, TYPES[name]))
        # The order of the rows is not that of the log.
        for topic, at, data in [*all_messages[1:], all_messages[0], ("/chatter", FIRST_NS, b"\x00\x01\x00\x00")]:
            database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", (numbers[topic], at, data))
    database.close()


def table(path, names, rows) -> None:
    path.write_text("\n".join([",".join(names), *(",".join(map(repr, map(float, row))) for row in rows)]) + "\n")


def test_a_bag_in_sqlite_gives_what_its_tables_give(tmp_path):
    robot = elbow()
    found, joints, seen = messages(robot)
    write_db3(tmp_path / "session.db3", found)
    table(tmp_path / "joints.csv", ["time[s]", *(f"{it}[rad]" for it in robot.reading_names)], joints)
    table(tmp_path / "seen.csv", ["time[s]", "x[m]", "y[m]", "z[m]"], seen)
    bag = poecal.Measurements.from_files(tmp_path / "session.db3", robot)
    tables = poecal.Measurements.from_files([tmp_path / "joints.csv", tmp_path / "seen.csv"], robot)
    assert len(bag) == len(tables) == STANDS
    for read in (bag, tables):
        assert pickle.loads(pickle.dumps(read)) == read
    apart = np.abs(bag.positions - tables.positions).max(), np.abs(bag.joints - tables.joints).max()
    print(f"{len(bag)} stands; {apart[0]:.1e} m and {apart[1]:.1e} rad from the tables")
    # Times in a table have fewer digits, and with them the ends of static intervals a row more or less.
    assert apart[0] < 2e-5 and apart[1] < 1e-9
    assert any("lag of 0.13" in note for note in bag.notes) or any("lag of 0.14" in note for note in bag.notes), bag.notes

    # In parts, in a folder.
    folder = tmp_path / "bag"
    folder.mkdir()
    half = len(found) // 2
    write_db3(folder / "bag_0.db3", found[:half])
    write_db3(folder / "bag_1.db3", found[half:])
    parts = poecal.Measurements.from_files(folder, robot)
    assert np.array_equal(parts.positions, bag.positions) and np.array_equal(parts.joints, bag.joints)


def test_what_is_no_bag_is_named(tmp_path):
    robot = elbow()
    found, _, _ = messages(robot)
    whole = tmp_path / "session.db3"
    write_db3(whole, found)

    def refused(name: str, content: bytes) -> str:
        (tmp_path / name).write_bytes(content)
        with pytest.raises(poecal.MeasurementError) as error:
            poecal.Measurements.from_files(tmp_path / name, robot)
        words = str(error.value)
        assert name in words and "\n" not in words
        return words

    content = whole.read_bytes()
    assert "found a database that cannot be read" in refused("cut.db3", content[: len(content) // 3])
    with sqlite3.connect(tmp_path / "other.sqlite") as database:
        database.execute("CREATE TABLE songs(id INTEGER)")
    database.close()
    words = refused("other.db3", (tmp_path / "other.sqlite").read_bytes())
    assert "no such table: topics" in words and "expected a ROS 2 bag in SQLite" in words
    packed = [(topic, at, b"\x28\xb5\x2f\xfd" + data) for topic, at, data in found]
    write_db3(tmp_path / "packed.sqlite", packed)
    assert "`rosbags-convert --src BAG --dst NEW --dst-storage mcap`" in refused("packed.db3", (tmp_path / "packed.sqlite").read_bytes())
    # Only joints.
    write_db3(tmp_path / "joints.sqlite", [it for it in found if it[0] == "/joint_states"])
    assert "/joint_states" in refused("joints.db3", (tmp_path / "joints.sqlite").read_bytes())
    with pytest.raises(poecal.Error) as error:
        (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n")
        poecal.Measurements.from_files(tmp_path / "old.bag", robot)
    assert "rosbags-convert" in str(error.value)
