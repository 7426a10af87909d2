"""Forward kinematics of the URDFs beside this file, by Pinocchio: the reference of crates/poecal-results/tests/it/fk_reference.rs.

    pip install pin numpy
    python crates/poecal-testing/data/fk_reference.py

writes fk_reference.json: for each URDF the tip link, the names of the readings, and 20 configurations with the pose of the tip
in base_link. Mimic relations are not left to Pinocchio: it gets every joint's own value, computed here from the leader's.
"""

import json
import pathlib
import xml.etree.ElementTree as xml

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).parent
TIPS = {
    "continuous": "link3",
    "elbow": "tool",
    "extreme_rpy": "tool",
    "fixed_between": "tool",
    "gantry": "tool",
    "mimic_column": "tool",
    "non_unit_axis": "link4",
    "random_origins": "tip",
    "scara": "tool0",
    "seven_axis": "link7",
}


def mimics(text):
    """Follower -> (leader, multiplier, offset)."""
    return {
        joint.get("name"): (m.get("joint"), float(m.get("multiplier", 1)), float(m.get("offset", 0)))
        for joint in xml.fromstring(text).findall("joint")
        for m in joint.findall("mimic")
    }


def value(joint, readings, followers):
    if joint not in followers:
        return readings[joint]
    leader, multiplier, offset = followers[joint]
    return multiplier * value(leader, readings, followers) + offset


def reference(path, tip, rng):
    text = path.read_text()
    followers = mimics(text)
    model = pin.buildModelFromXML(text)
    data = model.createData()
    frame, base = model.getFrameId(tip), model.getFrameId("base_link")
    on_chain = [model.names[i] for i in model.supports[model.frames[frame].parentJoint] if i > 0]
    names = sorted({leader_of(joint, followers) for joint in on_chain})
    configurations = []
    for _ in range(20):
        readings = {name: rng.uniform(-2, 2) for name in names}
        q = pin.neutral(model)
        for i in range(1, model.njoints):
            joint = model.names[i]
            if leader_of(joint, followers) not in readings:
                continue
            theta, at = value(joint, readings, followers), model.joints[i].idx_q
            q[at : at + model.joints[i].nq] = [theta] if model.joints[i].nq == 1 else [np.cos(theta), np.sin(theta)]
        pin.framesForwardKinematics(model, data, q)
        pose = data.oMf[base].actInv(data.oMf[frame])
        configurations.append(
            {
                "readings": [readings[name] for name in names],
                "position_m": pose.translation.tolist(),
                "rotation": pose.rotation.tolist(),
            }
        )
    return {"urdf": path.name, "tip": tip, "readings": names, "configurations": configurations}


def leader_of(joint, followers):
    while joint in followers:
        joint = followers[joint][0]
    return joint


if __name__ == "__main__":
    rng = np.random.default_rng(1)
    robots = [reference(HERE / "urdf" / f"{name}.urdf", tip, rng) for name, tip in TIPS.items()]
    lines = ['{"pinocchio": "%s", "robots": [' % pin.__version__]
    for robot in robots:
        configurations = robot.pop("configurations")
        lines.append(json.dumps(robot)[:-1] + ', "configurations": [')
        lines += [json.dumps(configuration) + "," for configuration in configurations]
        lines[-1] = lines[-1][:-1] + "]},"
    lines[-1] = lines[-1][:-1] + "]}"
    (HERE / "fk_reference.json").write_text("\n".join(lines) + "\n")
