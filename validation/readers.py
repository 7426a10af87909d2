"""Tips of exported arms by packages that read them, in the environment of one package; validation/exports runs it.

    python validation/readers.py PACKAGE JOBS.json POSES.jsonl

A job has the file, its form, the links of base and tip, and configurations by the joints' names. A line of the answer has the poses of the tip in
the base, or the package's words.
"""

import json
import math
import sys
import xml.etree.ElementTree as xml
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Matrix = npt.NDArray[np.float64]
Row = dict[str, float]
# Pose of a link or of the base, by its name.
Links = Callable[[str], Matrix]


def pose(rotation: Any, place: Any) -> Matrix:
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = np.reshape(rotation, (3, 3)), place
    return found


def by_quaternion(numbers: Any, place: Any) -> Matrix:
    """The pose of a quaternion with w first."""
    w, x, y, z = np.array(numbers, float) / np.linalg.norm(numbers)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return pose(rows, place)


def inverse(frame: Matrix) -> Matrix:
    return pose(frame[:3, :3].T, -frame[:3, :3].T @ frame[:3, 3])


def moved(kind: str, value: float) -> Matrix:
    """The motion of a joint about or along z."""
    if kind == "prismatic":
        return pose(np.eye(3), [0, 0, value])
    c, s = math.cos(value), math.sin(value)
    return pose([[c, -s, 0], [s, c, 0], [0, 0, 1]], np.zeros(3))


class Job:
    """A file with what is asked of it."""

    def __init__(self, words: dict[str, Any]) -> None:
        self.path: str = words["path"]
        self.form: str = words["form"]
        self.base: str = words["base"]
        self.tip: str = words["tip"]
        self.rows: list[Row] = words["rows"]
        self.option: bool = words["option"]
        # Where a reader has no sites: the body that has it is the tip, with the site behind.
        self.behind = np.eye(4)
        if words["by_hand"]:
            parents = {site.get("name"): (body, site) for body in xml.parse(self.path).iter("body") for site in body.findall("site")}
            body, site = parents[self.tip]
            place, turn = ([float(word) for word in site.get(name, "").split()] for name in ("pos", "quat"))
            self.tip, self.behind = body.get("name", ""), by_quaternion(turn, place)

    def text(self) -> str:
        return Path(self.path).read_text()

    def poses(self, links: Callable[[Row], Links]) -> list[Matrix]:
        """The tip in the base, of each configuration."""
        found = []
        for row in self.rows:
            at = links(row)
            found.append(inverse(at(self.base)) @ at(self.tip) @ self.behind)
        return found


def pinocchio(job: Job) -> list[Matrix]:
    import pinocchio as pin

    model = pin.buildModelFromMJCF(job.path) if job.form == "mjcf" else pin.buildModelFromUrdf(job.path, mimic=job.option)
    data = model.createData()

    def links(row: Row) -> Links:
        q = pin.neutral(model)
        for name, value in row.items():
            joint = model.joints[model.getJointId(name)]
            q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [math.cos(value), math.sin(value)]
        pin.framesForwardKinematics(model, data, q)
        return lambda name: np.array(data.oMf[model.getFrameId(name)].homogeneous)

    return job.poses(links)


def mujoco(job: Job) -> list[Matrix]:
    import mujoco as mj

    spec = mj.MjSpec.from_file(job.path)
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mj.MjData(model)

    def links(row: Row) -> Links:
        for name, value in row.items():
            data.joint(name).qpos = value
        mj.mj_kinematics(model, data)

        def at(name: str) -> Matrix:
            thing = data.site(name) if name == job.tip and job.form == "mjcf" else data.body("world" if job.form == "urdf" and name == job.base else name)
            return pose(thing.xmat, thing.xpos)

        return at

    return job.poses(links)


def drake(job: Job) -> list[Matrix]:
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(1e-3)
    Parser(plant).AddModels(job.path)
    plant.Finalize()
    context = plant.CreateDefaultContext()

    def links(row: Row) -> Links:
        for name, value in row.items():
            joint = plant.GetJointByName(name)
            (joint.set_translation if joint.type_name() == "prismatic" else joint.set_angle)(context, value)
        return lambda name: np.array(plant.GetFrameByName(name).CalcPoseInWorld(context).GetAsMatrix4())

    return job.poses(links)


def yourdfpy(job: Job) -> list[Matrix]:
    from yourdfpy import URDF

    robot = URDF.load(job.path)

    def links(row: Row) -> Links:
        robot.update_cfg(row)
        return lambda name: np.array(robot.get_transform(name, job.base))

    return job.poses(links)


def urchin(job: Job) -> list[Matrix]:
    from urchin import URDF

    robot = URDF.load(job.path)
    return job.poses(lambda row: robot.link_fk(row, use_names=True).__getitem__)


def manipulapy(job: Job) -> list[Matrix]:
    from ManipulaPy.urdf import URDF

    robot = URDF.load(job.path)
    return job.poses(lambda row: robot.link_fk(dict(row), use_names=True).__getitem__)


def fieldpilot(job: Job) -> list[Matrix]:
    import fieldpilot_urdf

    robot = fieldpilot_urdf.from_file(job.path)
    return job.poses(lambda row: fieldpilot_urdf.forward_kinematics(robot, dict(row)).__getitem__)


def ikpy(job: Job) -> list[Matrix]:
    from ikpy.chain import Chain

    chain = Chain.from_urdf_file(job.path, base_elements=[job.base])
    return [np.array(chain.forward_kinematics([row.get(link.name, 0.0) for link in chain.links])) for row in job.rows]


def kinpy(job: Job) -> list[Matrix]:
    import kinpy as kp

    chain = {"urdf": kp.build_chain_from_urdf, "sdf": kp.build_chain_from_sdf, "mjcf": kp.build_chain_from_mjcf}[job.form](job.text())

    def links(row: Row) -> Links:
        frames = chain.forward_kinematics(row)
        # The frame of an MJCF body is before its joint, that of the joint behind.
        return lambda name: np.array(frames[f"{name}_child" if f"{name}_child" in frames else name].matrix())

    return job.poses(links)


def pytransform3d(job: Job) -> list[Matrix]:
    from pytransform3d.urdf import UrdfTransformManager

    manager = UrdfTransformManager()
    manager.load_urdf(job.text())

    def links(row: Row) -> Links:
        for name, value in row.items():
            manager.set_joint(name, value)
        return lambda name: np.array(manager.get_transform(name, job.base))

    return job.poses(links)


def klampt(job: Job) -> list[Matrix]:
    from klampt import WorldModel

    world = WorldModel()
    if not world.loadRobot(job.path):
        raise ValueError("loadRobot returns False")
    robot = world.robot(0)
    names = [robot.link(index).getName() for index in range(robot.numLinks())]

    def links(row: Row) -> Links:
        for name, value in row.items():
            # A driver is named by its link.
            robot.driver(name.replace("joint", "link")).setValue(value)
        robot.setConfig(robot.getConfig())

        def at(name: str) -> Matrix:
            turn, place = robot.link(names.index(name)).getTransform()
            return pose(np.reshape(turn, (3, 3)).T, place)

        return at

    return job.poses(links)


def skrobot(job: Job) -> list[Matrix]:
    from skrobot.models.urdf import RobotModelFromURDF

    robot = RobotModelFromURDF(urdf_file=job.path)

    def links(row: Row) -> Links:
        for name, value in row.items():
            getattr(robot, name).joint_angle(value)
        return lambda name: np.array(getattr(robot, name).worldcoords().T())

    return job.poses(links)


def roboticstoolbox(job: Job) -> list[Matrix]:
    import roboticstoolbox as rtb

    robot = rtb.Robot.URDF(job.path)

    def tip(row: Row) -> Matrix:
        q = np.zeros(robot.n)
        for link in robot.links:
            if link.isjoint and link._joint_name in row:
                q[link.jindex] = row[link._joint_name]
        return np.array(robot.fkine(q, end=job.tip).A)

    return [tip(row) for row in job.rows]


def compas(job: Job) -> list[Matrix]:
    from compas_robots import RobotModel

    robot = RobotModel.from_urdf_file(job.path)

    def tip(row: Row) -> Matrix:
        frame = robot.forward_kinematics(dict(row), link_name=job.tip)
        return pose(np.array([list(frame.xaxis), list(frame.yaxis), list(frame.zaxis)]).T, list(frame.point))

    return [tip(row) for row in job.rows]


def pybullet(job: Job) -> list[Matrix]:
    import pybullet as bullet

    if not bullet.isConnected():
        bullet.connect(bullet.DIRECT)
    if job.form == "urdf":
        body = bullet.loadURDF(job.path, useFixedBase=True)
    else:
        body = {"sdf": bullet.loadSDF, "mjcf": bullet.loadMJCF}[job.form](job.path)[0]
    infos = [bullet.getJointInfo(body, index) for index in range(bullet.getNumJoints(body))]
    joints, bodies = ({info[column].decode(): info[0] for info in infos} for column in (1, 12))

    def links(row: Row) -> Links:
        for name, value in row.items():
            bullet.resetJointState(body, joints[name], value)

        def at(name: str) -> Matrix:
            if name not in bodies and name == job.base:
                return np.eye(4)
            state = bullet.getLinkState(body, bodies[name], computeForwardKinematics=True)
            x, y, z, w = state[5]
            return by_quaternion([w, x, y, z], state[4])

        return at

    return job.poses(links)


def newton(job: Job) -> list[Matrix]:
    import newton as nt
    import warp as wp

    wp.config.quiet = True
    builder = nt.ModelBuilder()
    if job.form == "urdf":
        builder.add_urdf(job.path, collapse_fixed_joints=False)
    else:
        {"mjcf": builder.add_mjcf, "usd": builder.add_usd}[job.form](job.path)
    model = builder.finalize(device="cpu")
    joints, bodies, shapes = ([label.split("/")[-1] for label in labels] for labels in (model.joint_label, model.body_label, model.shape_label))
    starts = model.joint_q_start.numpy()

    def frame(numbers: Any) -> Matrix:
        x, y, z, qx, qy, qz, qw = (float(number) for number in numbers)
        return by_quaternion([qw, qx, qy, qz], [x, y, z])

    def links(row: Row) -> Links:
        q = model.joint_q.numpy()
        for name, value in row.items():
            q[starts[joints.index(name)]] = value
        state = model.state()
        nt.eval_fk(model, wp.array(q, dtype=float, device="cpu"), model.joint_qd, state)
        poses = state.body_q.numpy()

        def at(name: str) -> Matrix:
            if name in bodies:
                return frame(poses[bodies.index(name)])
            if name == job.base:
                return np.eye(4)
            shape = shapes.index(name)
            return frame(poses[model.shape_body.numpy()[shape]]) @ frame(model.shape_transform.numpy()[shape])

        return at

    return job.poses(links)


def dartpy(job: Job) -> list[Matrix]:
    import dartpy as dart

    if job.form == "urdf":
        robot = dart.utils.DartLoader().parseSkeleton(job.path)
    elif job.form == "sdf":
        robot = dart.utils.SdfParser.readSkeleton(job.path)
    else:
        robot = dart.utils.MjcfParser.readWorld(job.path).getSkeleton(0)
    if robot is None:
        raise ValueError("the parser returns None")

    def links(row: Row) -> Links:
        for name, value in row.items():
            robot.getJoint(name).setPosition(0, value)
        return lambda name: np.array(robot.getBodyNode(name).getWorldTransform().matrix())

    return job.poses(links)


def idyntree(job: Job) -> list[Matrix]:
    import idyntree.bindings as idt

    loader = idt.ModelLoader()
    if not loader.loadModelFromFile(job.path):
        raise ValueError("loadModelFromFile returns False")
    robot = idt.KinDynComputations()
    robot.loadRobotModel(loader.model())
    model = robot.model()
    gravity = idt.Vector3()
    gravity.zero()

    def tip(row: Row) -> Matrix:
        q, speeds = idt.VectorDynSize(model.getNrOfDOFs()), idt.VectorDynSize(model.getNrOfDOFs())
        q.zero()
        speeds.zero()
        for name, value in row.items():
            q.setVal(model.getJoint(model.getJointIndex(name)).getDOFsOffset(), value)
        robot.setRobotState(q, speeds, gravity)
        return np.array(robot.getRelativeTransform(job.base, job.tip).asHomogeneousTransform().toNumPy())

    return [tip(row) for row in job.rows]


def urdf2casadi(job: Job) -> list[Matrix]:
    from urdf2casadi.urdfparser import URDFparser

    parser = URDFparser()
    parser.from_file(job.path)
    found = parser.get_forward_kinematics(job.base, job.tip)
    return [np.array(found["T_fk"]([row.get(name, 0.0) for name in found["joint_names"]])) for row in job.rows]


def dynibo(job: Job) -> list[Matrix]:
    from dynibo import Robot

    robot = Robot.from_urdf(job.path)

    def tip(row: Row) -> Matrix:
        found = robot.forward_kinematics(np.array(list(row.values())), robot.link_id(job.tip))
        return by_quaternion(np.roll(found.rotation_xyzw, 1), found.translation)

    return [tip(row) for row in job.rows]


def pykin(job: Job) -> list[Matrix]:
    from pykin.robots.single_arm import SingleArm

    robot = SingleArm(job.path)
    robot.setup_link_name(job.base, job.tip)

    def links(row: Row) -> Links:
        frames = robot.forward_kin(np.array(list(row.values())))
        return lambda name: np.array(frames[name].h_mat)

    return job.poses(links)


def sapien(job: Job) -> list[Matrix]:
    import sapien as sp

    scene = sp.Scene([sp.physx.PhysxCpuSystem()])
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    robot = loader.load(job.path)
    names = [joint.name for joint in robot.active_joints]

    def links(row: Row) -> Links:
        robot.set_qpos(np.array([row.get(name, 0.0) for name in names]))
        poses = {link.name: link.entity_pose.to_transformation_matrix().astype(float) for link in robot.links}
        return poses.__getitem__

    return job.poses(links)


def usd_core(job: Job) -> list[Matrix]:
    """The frames of the file's joints, multiplied."""
    from pxr import Usd, UsdPhysics

    joints = {}
    stage = Usd.Stage.Open(job.path)
    for prim in stage.Traverse():
        joint = UsdPhysics.Joint(prim)
        if joint and joint.GetBody0Rel().GetTargets():
            joints[joint.GetBody1Rel().GetTargets()[0].name] = joint

    def frame(place: Any, turn: Any) -> Matrix:
        return by_quaternion([turn.GetReal(), *turn.GetImaginary()], list(place))

    def tip(row: Row) -> Matrix:
        found, link = np.eye(4), job.tip
        while link != job.base:
            joint = joints[link]
            prim = joint.GetPrim()
            kind = "prismatic" if prim.IsA(UsdPhysics.PrismaticJoint) else "revolute"
            before = frame(joint.GetLocalPos0Attr().Get(), joint.GetLocalRot0Attr().Get())
            behind = frame(joint.GetLocalPos1Attr().Get(), joint.GetLocalRot1Attr().Get())
            found = before @ moved(kind, row.get(prim.GetName(), 0.0)) @ inverse(behind) @ found
            link = joint.GetBody0Rel().GetTargets()[0].name
        return found

    return [tip(row) for row in job.rows]


def modern_robotics(job: Job) -> list[Matrix]:
    """The screws of the TOML form, whose linear part comes first."""
    import tomllib

    import modern_robotics as mr

    robot = tomllib.loads(job.text())
    # A joint that follows another one has its value from the caller.
    screws = np.array([[*joint["screw"].get("w", [0, 0, 0]), *joint["screw"]["v"]] for joint in robot["joint"]], float).T
    home = by_quaternion(np.roll(robot["home"].get("quaternion_xyzw", [0, 0, 0, 1]), 1), robot["home"]["position"])
    return [np.array(mr.FKinSpace(home, screws, [row.get(joint["name"], 0.0) for joint in robot["joint"]])) for row in job.rows]


def main() -> None:
    name, jobs, answer = sys.argv[1:]
    reader: Callable[[Job], list[Matrix]] = globals()[name]
    with Path(answer).open("a") as out:
        for words in json.loads(Path(jobs).read_text()):
            try:
                found: dict[str, Any] = {"poses": [np.asarray(it, float).tolist() for it in reader(Job(words))]}
            except Exception as error:  # noqa: BLE001 a package may raise anything
                found = {"refused": f"{type(error).__name__}: {error}".strip().splitlines()[0]}
            out.write(json.dumps(found) + "\n")
            out.flush()


if __name__ == "__main__":
    main()
