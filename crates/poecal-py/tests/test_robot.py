"""Robots: made from arrays and files, and the poses of their tips."""

import copy
import pickle

import numpy as np
import poecal
import pytest
from robots import ELBOW, configurations, elbow

# Rounding of a dozen products of poses of about a metre.
ROUNDING = 1e-14


def dh_pose(q) -> np.ndarray:
    """Standard Denavit-Hartenberg by the book."""
    pose = np.eye(4)
    for a, alpha, d, theta, value in zip(*ELBOW.values(), q, strict=True):
        c, s, ca, sa = np.cos(theta + value), np.sin(theta + value), np.cos(alpha), np.sin(alpha)
        pose = pose @ [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    return pose


def hat(screw) -> np.ndarray:
    v, (x, y, z) = screw[:3], screw[3:]
    return np.array([[0, -z, y, v[0]], [z, 0, -x, v[1]], [-y, x, 0, v[2]], [0, 0, 0, 0]])


def exponential(matrix) -> np.ndarray:
    """By scaling and squaring of the series."""
    small, total, term = matrix / 2**12, np.eye(4), np.eye(4)
    for k in range(1, 8):
        term = term @ small / k
        total = total + term
    return np.linalg.matrix_power(total, 2**12)


def test_forward_kinematics_is_that_of_the_parameters():
    robot, joints = elbow(), configurations(20)
    found = robot.forward_kinematics(joints)
    assert found.shape == (20, 4, 4) and found.dtype == np.float64
    worst = np.abs(found - [dh_pose(q) for q in joints]).max()
    print(f"worst difference {worst:.1e}")
    assert worst < ROUNDING


def test_forward_kinematics_is_the_product_of_exponentials():
    robot = elbow()
    for q in configurations(5):
        pose = np.eye(4)
        for screw, value in zip(robot.screws, q, strict=True):
            pose = pose @ exponential(hat(screw) * value)
        # Squaring twelve times leaves some thousand roundings.
        assert np.abs(robot.forward_kinematics(q) - pose @ robot.home).max() < 1e-11


def test_one_configuration_gives_one_pose():
    robot, joints = elbow(), configurations(3)
    single = robot.forward_kinematics(joints[1])
    assert single.shape == (4, 4)
    assert (single == robot.forward_kinematics(joints)[1]).all()
    assert robot.forward_kinematics(np.empty((0, 6))).shape == (0, 4, 4)


def test_joint_frames_are_those_of_the_chain():
    robot, joints = elbow(), configurations(7)
    frames = robot.joint_poses(joints)
    assert frames.shape == (7, 6, 4, 4) and robot.joint_poses(joints[0]).shape == (6, 4, 4)
    for q, of_row in zip(joints, frames, strict=True):
        pose = np.eye(4)
        for screw, at_zero, value, frame in zip(robot.screws, robot.joint_frames, q, of_row, strict=True):
            pose = pose @ exponential(hat(screw) * value)
            assert np.abs(frame - pose @ at_zero).max() < 1e-11


def test_screws_make_the_same_robot_again():
    robot = elbow()
    again = poecal.Robot.from_screws(robot.screws, robot.home, limits=robot.limits, names=robot.joint_names)
    assert np.abs(again.forward_kinematics(configurations(9)) - robot.forward_kinematics(configurations(9))).max() < ROUNDING
    turned = np.hstack([robot.screws[:, 3:], robot.screws[:, :3]])
    assert (poecal.Robot.from_screws(turned, robot.home, angular_first=True).screws == again.screws).all()


def test_what_a_robot_says_of_itself():
    robot = poecal.Robot.from_dh(
        a_m=[0.3, 0.2], alpha_rad=[0, 0], d_m=[0, 0], theta_rad=[0, 0], kinds=["revolute", "prismatic"],
        names=["shoulder", "slide"], limits=[[-1, 1], [np.nan, np.nan]], convention="modified", name="arm",
    )  # fmt: skip
    assert (robot.name, robot.base_link, robot.tip_link) == ("arm", "base", "tip")
    assert robot.joint_names == robot.reading_names == ["shoulder", "slide"]
    assert robot.kinds == ["revolute", "prismatic"]
    assert robot.limits.tolist() == [[-1, 1], [-np.inf, np.inf]]
    assert robot.screws.shape == (2, 6) and robot.joint_frames.shape == (2, 4, 4) and robot.home.shape == (4, 4)
    assert "shoulder" in repr(robot)


def test_files_read_back(tmp_path):
    robot, joints = elbow(), configurations(9)
    for name, read in [("a.urdf", poecal.Robot.from_urdf), ("a.toml", poecal.Robot.from_toml), ("a.toml", poecal.Robot.read)]:
        robot.write(tmp_path / name, force=True)
        again = read(str(tmp_path / name))
        assert np.abs(again.forward_kinematics(joints) - robot.forward_kinematics(joints)).max() < 1e-12
        assert again.path == str(tmp_path / name)
    assert robot.to_text("toml") == (tmp_path / "a.toml").read_text()
    assert poecal.export(robot, out=tmp_path / "b.toml") == robot.to_text("toml")


def test_nothing_is_replaced_without_force(tmp_path):
    robot, mine = elbow(), tmp_path / "mine.toml"
    mine.write_text("mine")
    for write in [lambda **more: robot.write(mine, **more), lambda **more: poecal.export(robot, out=mine, **more)]:
        with pytest.raises(poecal.FileError, match="found this file, expected none"):
            write()
        assert mine.read_text() == "mine"
        write(force=True)
        assert mine.read_text() == robot.to_text("toml")
        mine.write_text("mine")
    robot.write(tmp_path / "robot.toml")
    robot = poecal.Robot.read(tmp_path / "robot.toml")
    with pytest.raises(poecal.FileError, match="found a file that this run reads"):
        poecal.export(robot, out=tmp_path / "robot.toml", force=True)
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["mine.toml", "robot.toml"]


def test_offsets_of_unknown_joints_are_refused():
    robot = elbow()
    with pytest.raises(poecal.OptionError, match="found no moving joint `joint7`.*did you mean `joint1`"):
        poecal.export(robot, format="toml", offset={"joint7": 0.1})


def test_offsets_become_screws_and_back(tmp_path):
    robot, joints = elbow(), configurations(9)
    poecal.export(robot, out=tmp_path / "moved.toml", offset={"joint2": 0.1, "joint5": -0.2})
    moved = poecal.Robot.read(tmp_path / "moved.toml")
    shifted = joints + [0, 0.1, 0, 0, -0.2, 0]
    assert np.abs(moved.forward_kinematics(joints) - robot.forward_kinematics(shifted)).max() < 1e-12
    found = poecal.offsets(robot, moved)
    assert [round(joint["offset_deg"], 6) for joint in found["joints"]] == [0, round(np.degrees(0.1), 6), 0, 0, round(np.degrees(-0.2), 6), 0]
    assert "joint5" in str(found)


@pytest.mark.parametrize("kind", ["arrays", "urdf", "toml"])
def test_copies_are_equal(kind, tmp_path):
    robot = elbow()
    if kind != "arrays":
        robot.write(tmp_path / f"robot.{kind}")
        robot = poecal.Robot.read(tmp_path / f"robot.{kind}")
    for again in [pickle.loads(pickle.dumps(robot)), copy.copy(robot), copy.deepcopy(robot)]:
        assert again == robot
        assert (again.forward_kinematics(configurations(5)) == robot.forward_kinematics(configurations(5))).all()
        assert again.path == robot.path
    assert robot != poecal.Robot.from_dh(**ELBOW)
    assert robot != 3
    with pytest.raises(TypeError):
        hash(robot)


def test_html_is_escaped():
    text = poecal.Robot.from_dh(**ELBOW, name="<b>&'\"")._repr_html_()
    assert "<b>" not in text and "&lt;b&gt;&amp;'&quot;" in text
