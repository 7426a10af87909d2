"""`hand_eye` and `tcp`: a camera and a tip are found from poses, and mistakes are named."""

import json

import numpy as np
import poecal
import pytest


def rotation(vector):
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector) / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def pose(vector, place):
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = rotation(vector), place
    return found


CAMERA = pose([0.1, 0.0, 1.5], [0.04, -0.06, 0.09])


def session(count=15):
    draw = np.random.default_rng(4)
    board = pose([3.0, 0.1, 0.2], [0.6, 0.1, 0.0])
    arm = np.array([pose([2.9, 0, 0] + draw.normal(0, 0.4, 3), [0.5, 0, 0.6] + draw.normal(0, 0.1, 3)) for _ in range(count)])
    noise = [pose(draw.normal(0, 5e-4, 3), draw.normal(0, 2e-4, 3)) for _ in range(count)]
    seen = np.array([np.linalg.inv(it @ CAMERA) @ board @ off for it, off in zip(arm, noise)])
    return arm, seen


def test_a_camera_is_found_within_its_bounds():
    arm, seen = session()
    found = poecal.hand_eye(arm, seen, camera="in-hand", frame_names=["base", "flange", "eye", "board"])
    frame = found["camera_frame"]
    off_mm = 1e3 * np.linalg.norm(np.array(frame["matrix"])[:3, 3] - CAMERA[:3, 3])
    print(f"{off_mm:.3f} mm off, bound {frame['bound95_mm']:.3f}")
    assert off_mm < frame["bound95_mm"] < 2
    assert (frame["parent"], frame["child"]) == ("flange", "eye")
    assert "command" not in found["inputs"]
    assert json.loads(found.to_json())["verdict"]["level"] == "good"
    assert "95 % within" in str(found)


def test_lists_the_other_way_round_are_found_and_said():
    arm, seen = session()
    found = poecal.hand_eye(np.linalg.inv(arm), seen, camera="in-hand")
    assert found["findings"][0]["kind"] == "inverted"
    assert found.warnings[0].startswith("the poses of the arm are inverted")
    # These are poses of a camera at the other end as well.
    with pytest.raises(poecal.Error, match="state target target-from-camera"):
        poecal.hand_eye(arm, np.linalg.inv(seen), camera="in-hand")
    stated = poecal.hand_eye(arm, np.linalg.inv(seen), camera="in-hand", target="target-from-camera")
    assert 1e3 * np.linalg.norm(np.array(stated["camera_frame"]["matrix"])[:3, 3] - CAMERA[:3, 3]) < stated["camera_frame"]["bound95_mm"]


def test_a_camera_at_the_other_end_is_refused():
    with pytest.raises(poecal.Error, match="run with camera in-hand"):
        poecal.hand_eye(*session(), camera="beside")


def test_a_tip_is_found_and_a_wrong_touch_named():
    draw = np.random.default_rng(5)
    tip, point = np.array([0.01, 0.0, 0.15]), np.array([0.6, 0.1, 0.05])
    turns = [rotation([3.0, 0, 0] + draw.normal(0, 0.4, 3)) for _ in range(8)]
    touches = np.array([np.vstack([np.column_stack([r, point - r @ tip + draw.normal(0, 1e-4, 3)]), [0, 0, 0, 1]]) for r in turns])
    touches[5, 0, 3] += 0.003
    found = poecal.tcp(touches, names=[f"P{k}" for k in range(8)])
    off_mm = 1e3 * np.linalg.norm(np.array(found["tips"][0]["position_m"]) - tip)
    assert off_mm < found["tips"][0]["bound95_mm"] < 1
    assert found["outliers"] == ["P5"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda arm, seen: (arm[:3], seen[:3]), "found 3 different poses"),
        (lambda arm, seen: (arm, seen[:4]), "camera_from_target"),
        (lambda arm, seen: (arm * [[[1], [1], [1], [2]]], seen), "base_from_flange: row 0"),
        (lambda arm, seen: (arm, np.full_like(seen, np.nan)), "camera_from_target"),
    ],
)
def test_mistakes_are_one_sentence(change, said):
    with pytest.raises(poecal.Error, match=said):
        poecal.hand_eye(*change(*session()), camera="in-hand")


def test_words_are_chosen_among_those_that_there_are():
    with pytest.raises(poecal.Error, match="in-hand"):
        poecal.hand_eye(*session(), camera="hand")
    with pytest.raises(poecal.Error, match="four names"):
        poecal.hand_eye(*session(), camera="beside", frame_names=["base"])
