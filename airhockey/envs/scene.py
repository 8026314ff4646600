"""The MuJoCo models: a table with a puck and one or two arms, and an arm alone.

The order of bodies is part of the model: robot 1, robot 2, table, puck. Another order changes the last bits of contacts and,
after a few bounces, the game. Names are those of the official package, since agents rely on them.
"""

import json
from collections.abc import Iterable
from functools import cache
from importlib import resources
from typing import Any

import mujoco
import numpy as np

from airhockey.envs import appearance
from airhockey.envs.editions import Scene
from airhockey.envs.specs import MALLET, PUCK, STRIKER, TABLE, TIMESTEP, FixedBody, Link, RobotSpec

RIM_WIDTH = 0.09
"""Width of the rims around the playing area, in [m]."""
FLOOR_HEIGHT = -0.1
"""Height of the floor, on which the robots stand, in [m]."""

_NO_FRICTION = (0.0, 0.0, 0.0)
_SURFACE_CONTACT = {
    "condim": 4,
    "friction": (0.08, 0.08, 0.0),
    "priority": 1,
    "solref": (0.0125, 0.5),
    "solimp": (0.9, 0.999, 0.001, 0.5, 2.0),
}
_RIM_CONTACT = {
    "condim": 6,
    "friction": (10000.0, 0.0, 0.0),
    "priority": 1,
    "solref": (0.0075, 0.1),
    "solimp": (0.99, 0.999, 0.001, 0.5, 2.0),
}
_PLANAR_CONTACT = {"condim": 4, "priority": 2, "solref": (0.02, 0.3)}
_HALF_TURN = (0.0, 0.0, 0.0, 1.0)
_ALONG_X = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)


def game_model(
    robot: RobotSpec, n_robots: int, visual: bool = True, edition_scene: Scene | None = None
) -> mujoco.MjModel:
    """A compiled scene: `n_robots` arms, the table and the puck.

    Args:
        robot: Which arm plays.
        n_robots: 1 or 2.
        visual: Also draw the links of the arms. Geoms that are only seen change nothing in the physics.
        edition_scene: What is particular to an edition; by default nothing, as in 2023.
    """
    particular = Scene() if edition_scene is None else edition_scene
    spec = _empty_spec()
    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=(40, 40, 40),
        pos=(0, 0, FLOOR_HEIGHT),
        rgba=appearance.FLOOR,
    )
    for number in range(1, n_robots + 1):
        base = spec.worldbody.add_body(
            name=f"{robot.prefix}_{number}/base",
            pos=robot.base_positions[number - 1],
            quat=_HALF_TURN if number == 2 else (1.0, 0.0, 0.0, 0.0),
        )
        _add_robot(spec, base, robot, number, visual, playing=True)
    _add_table(spec)
    _add_puck(spec)
    for number in range(1, n_robots + 1):
        _exclude_robot(spec, robot, number)
    spec.add_exclude(bodyname1="puck", bodyname2="table_surface")
    _make_particular(spec, robot, n_robots, particular)
    if visual:
        appearance.add_surroundings(spec)
    return spec.compile()


def _make_particular(spec: Any, robot: RobotSpec, n_robots: int, particular: Scene) -> None:
    """What an edition has of its own: how mallets meet the puck and each other, and the mark on the rim."""
    mallets = (
        [f"{robot.prefix}_{number}" for number in range(1, n_robots + 1)] if robot.universal_height is not None else []
    )
    for name, priority in zip(mallets, particular.mallet_priority, strict=False):
        spec.geom(f"{name}/ee").priority = priority
    if len(mallets) == 2 and not particular.arms_collide:  # nothing else of an iiwa collides
        spec.add_exclude(bodyname1=f"{mallets[0]}/striker_mallet", bodyname2=f"{mallets[1]}/striker_mallet")
    if particular.target:
        spec.body("rim").add_geom(
            name="target",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=(0.01, 0, 0),
            pos=(0, 0, -0.05),
            contype=0,
            conaffinity=0,
            rgba=appearance.PUCK,
        )


def robot_model(robot: RobotSpec) -> mujoco.MjModel:
    """The arm alone, base at the origin, without the mallet: what the joint controller and the agents know."""
    return _robot_spec(robot).compile()


def robot_xml(robot: RobotSpec) -> str:
    """The same as MJCF, for agents in an interpreter of their own."""
    spec = _robot_spec(robot)
    spec.compile()
    return str(spec.to_xml())


def _robot_spec(robot: RobotSpec) -> Any:
    spec = _empty_spec()
    base = spec.worldbody.add_body(name=f"{robot.prefix}_1/base")
    _add_robot(spec, base, robot, 1, visual=False, playing=False)
    _add_outline(spec, robot)
    return spec


def _empty_spec() -> Any:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    option = spec.option
    option.timestep = TIMESTEP
    option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 1.0
    option.iterations = 100
    option.tolerance = 1e-8
    # A state that diverged must be seen, not replaced by the initial one in silence.
    option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    spec.default.geom.condim = 4
    spec.default.geom.solref = (0.02, 0.3)
    return spec


def _add_robot(spec: Any, base: Any, robot: RobotSpec, number: int, visual: bool, playing: bool) -> None:
    """Add the links, the tip and, for a robot that plays, the geoms that touch the puck; then the motors."""
    name = f"{robot.prefix}_{number}"
    if visual:
        appearance.add_base(base, robot, number)
    body = base
    for index, link in enumerate(robot.links, start=1):
        body = _add_link(body, f"{name}/{robot.link_prefix}_{index}", f"{name}/joint_{index}", link)
        if visual:
            appearance.add_link(body, robot, number, index)
        if playing and robot.universal_height is None:
            _add_planar_geoms(body, index)
    for fixed in robot.tip:
        body = _add_fixed(body, f"{name}/{fixed.name}", fixed)
        if visual:
            appearance.add_tip(body, robot, number)
        if playing and robot.universal_height is None:
            _add_planar_tip_geoms(body, fixed.name, number)
    joints = [(f"{name}/joint_{index}", link.torque_limit) for index, link in enumerate(robot.links, start=1)]
    if playing and robot.universal_height is not None:
        _add_striker(body, name)
        joints += [(f"{name}/striker_joint_{index}", STRIKER.torque_limit) for index in (1, 2)]
    for joint, torque_limit in joints:
        motor = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.set_to_motor()
        motor.ctrllimited = True
        motor.ctrlrange = (-torque_limit, torque_limit)


def _add_outline(spec: Any, robot: RobotSpec) -> None:
    """As many geoms as the official robot-only model has, under its names: the planar arm's own, one a body for the iiwa."""
    name = f"{robot.prefix}_1"
    appearance.add_pedestal(spec.body(f"{name}/base"), robot)
    for index in range(1, robot.n_joints + 1):
        body = spec.body(f"{name}/{robot.link_prefix}_{index}")
        if robot.universal_height is None:
            _add_planar_geoms(body, index)
        else:
            appearance.add_tube(body, robot, index)
    for fixed in robot.tip:
        body = spec.body(f"{name}/{fixed.name}")
        if robot.universal_height is None:
            _add_planar_tip_geoms(body, fixed.name, 1)
        else:
            appearance.add_rod(body, robot)


def _add_link(parent: Any, name: str, joint: str, link: Link) -> Any:
    body = parent.add_body(
        name=name,
        pos=link.position,
        quat=link.quaternion,
        mass=link.mass,
        ipos=link.center_of_mass,
        fullinertia=link.inertia,
        explicitinertial=True,
    )
    body.add_joint(
        name=joint,
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=(0, 0, 1),
        limited=True,
        range=(-link.position_limit, link.position_limit),
        damping=link.damping,
        frictionloss=link.friction_loss,
        armature=link.armature,
    )
    return body


def _add_fixed(parent: Any, name: str, fixed: FixedBody) -> Any:
    return parent.add_body(
        name=name,
        pos=fixed.position,
        mass=fixed.mass,
        ipos=(0, 0, 0),  # without it MuJoCo takes the body's position
        inertia=fixed.inertia,
        explicitinertial=True,
    )


def _add_planar_geoms(body: Any, index: int) -> None:
    """The planar arm's links are rods along x that can touch the puck."""
    half_length = 0.275 if index == 1 else 0.22
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=(0.04, half_length, 0),
        pos=(half_length, 0, 0),
        quat=_ALONG_X,
        rgba=appearance.PLANAR_LINK,
        **_PLANAR_CONTACT,
    )
    if index > 1:
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(0.05, 0, 0), rgba=appearance.PLANAR_JOINT, **_PLANAR_CONTACT
        )


def _add_planar_tip_geoms(body: Any, name: str, number: int) -> None:
    cylinder = mujoco.mjtGeom.mjGEOM_CYLINDER
    if name == "body_hand":
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(0.05, 0, 0), rgba=appearance.PLANAR_JOINT, **_PLANAR_CONTACT
        )
        body.add_geom(
            type=cylinder, size=(0.01, 0.075, 0), pos=(0, 0, -0.075), rgba=appearance.PLANAR_LINK, **_PLANAR_CONTACT
        )
        return
    body.add_geom(
        name=f"planar_robot_{number}/ee",
        type=cylinder,
        size=(MALLET.radius, 0.01, 0),
        pos=(0, 0, 0.01),
        friction=_NO_FRICTION,
        rgba=appearance.player_color(number),
        **_PLANAR_CONTACT,
    )


def _add_striker(tip: Any, name: str) -> None:
    """The mallet on its universal joint, the only part of an iiwa that collides."""
    mallet = tip.add_body(
        name=f"{name}/striker_mallet",
        mass=STRIKER.mass,
        ipos=STRIKER.center_of_mass,
        inertia=(STRIKER.inertia,) * 3,
        explicitinertial=True,
    )
    for index, axis in ((1, (0, 1, 0)), (2, (1, 0, 0))):
        mallet.add_joint(
            name=f"{name}/striker_joint_{index}",
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=axis,
            limited=True,
            range=(-STRIKER.range, STRIKER.range),
        )
    mallet.add_geom(
        name=f"{name}/ee",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=(MALLET.radius, 0.03, 0),
        pos=(0, 0, 0.0505),
        friction=_NO_FRICTION,
        rgba=appearance.player_color(1 if name.endswith("1") else 2),
    )


def _add_table(spec: Any) -> None:
    half_length, half_width = TABLE.length / 2 + RIM_WIDTH, TABLE.width / 2 + RIM_WIDTH
    end, side = (TABLE.length + RIM_WIDTH) / 2, (TABLE.width + RIM_WIDTH) / 2
    box = mujoco.mjtGeom.mjGEOM_BOX
    surface = spec.worldbody.add_body(name="table_surface")
    surface.add_geom(
        name="surface",
        type=box,
        size=(half_length, half_width, 0.0505),
        pos=(0, 0, -0.0505),
        rgba=appearance.SURFACE,
        **_SURFACE_CONTACT,
    )
    rim = spec.worldbody.add_body(name="rim")
    for name, y in (("rim_left", side), ("rim_right", -side)):
        rim.add_geom(
            name=name,
            type=box,
            size=(half_length, RIM_WIDTH / 2, 0.015),
            pos=(0, y, 0.015),
            rgba=appearance.RIM,
            **_RIM_CONTACT,
        )
    _add_rim_mesh(spec)
    for place, x in (("home", end), ("away", -end)):
        for corner, y, quaternion in (("l", 0.322, (1, 0, 0, 0)), ("r", -0.322, _HALF_TURN)):
            rim.add_geom(
                name=f"rim_{place}_{corner}",
                type=mujoco.mjtGeom.mjGEOM_MESH,
                meshname="rim_block",
                pos=(x, y, 0),
                quat=quaternion,
                rgba=appearance.RIM,
                **_RIM_CONTACT,
            )
    for place, x in (("home", -end), ("away", end)):
        rim.add_geom(
            name=f"rim_{place}_top",
            type=box,
            size=(RIM_WIDTH / 2, TABLE.width / 2, 0.01),
            pos=(x, 0, 0.02),
            contype=0,
            conaffinity=0,
            rgba=appearance.RIM_TOP,
        )


@cache
def _rim_block() -> dict[str, Any]:
    text = resources.files("airhockey.envs").joinpath("assets/rim_block.json").read_text()
    block: dict[str, Any] = json.loads(text)
    return block


def _add_rim_mesh(spec: Any) -> None:
    block = _rim_block()
    spec.add_mesh(
        name="rim_block",
        uservert=_flat(block["vertices"]),
        userface=_flat(block["triangles"]),
        scale=(0.001, 0.001, 0.001),
        smoothnormal=True,
    )


def _flat(rows: Iterable[Iterable[float]]) -> list[float]:
    return [value for row in rows for value in row]


def _add_puck(spec: Any) -> None:
    carriage = spec.worldbody.add_body(name="puck_base")
    slide = mujoco.mjtJoint.mjJNT_SLIDE
    for name, kind, axis, damping in (
        ("puck_x", slide, (1, 0, 0), PUCK.slide_damping),
        ("puck_y", slide, (0, 1, 0), PUCK.slide_damping),
        ("puck_yaw", mujoco.mjtJoint.mjJNT_HINGE, (0, 0, 1), PUCK.yaw_damping),
    ):
        carriage.add_joint(name=name, type=kind, axis=axis, damping=damping, limited=False)
    puck = carriage.add_body(name="puck", mass=PUCK.mass, ipos=(0, 0, 0), inertia=PUCK.inertia, explicitinertial=True)
    puck.add_geom(
        name="puck",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=(PUCK.radius, PUCK.half_height, 0),
        pos=(0, 0, PUCK.half_height),
        condim=4,
        priority=0,
        rgba=appearance.PUCK,
    )


def _exclude_robot(spec: Any, robot: RobotSpec, number: int) -> None:
    """A robot touches neither the table nor its rims, and an iiwa's mallet does not touch the floor."""
    name = f"{robot.prefix}_{number}"
    bodies = ["base"]
    bodies += [f"{robot.link_prefix}_{index}" for index in range(1, robot.n_joints + 1)]
    bodies += [fixed.name for fixed in robot.tip]
    if robot.universal_height is not None:
        bodies.append("striker_mallet")
        spec.add_exclude(bodyname1=f"{name}/striker_mallet", bodyname2="world")
    for body in bodies:
        for part in ("table_surface", "rim"):
            spec.add_exclude(bodyname1=f"{name}/{body}", bodyname2=part)
