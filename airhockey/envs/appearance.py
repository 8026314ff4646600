"""What the scene looks like: colours, and arms drawn from primitives of our own. Nothing here takes part in the physics."""

from typing import Any

import mujoco

from airhockey.envs.specs import TABLE, RobotSpec

Color = tuple[float, float, float, float]

FLOOR: Color = (0.42, 0.45, 0.50, 1.0)
SURFACE: Color = (0.90, 0.92, 0.94, 1.0)
RIM: Color = (0.16, 0.22, 0.33, 1.0)
RIM_TOP: Color = (0.16, 0.22, 0.33, 0.35)
PUCK: Color = (0.85, 0.15, 0.12, 1.0)
PLANAR_LINK: Color = (0.75, 0.77, 0.80, 1.0)
PLANAR_JOINT: Color = (0.35, 0.38, 0.43, 1.0)
SHELL: Color = (0.87, 0.88, 0.89, 1.0)
JOINT_RING: Color = (0.95, 0.45, 0.10, 1.0)
ROD: Color = (0.25, 0.27, 0.30, 1.0)
LINE: Color = (0.20, 0.35, 0.75, 1.0)
_PLAYERS: tuple[Color, Color] = ((0.12, 0.42, 0.86, 1.0), (0.10, 0.60, 0.32, 1.0))

CIRCLE_RADIUS = 0.14
"""Of the circle around the centre, in [m]."""
PAINT = 0.0004
"""Half the thickness of a line, in [m]."""
SCENE_EXTENT = 2.2
"""Half the size of what is to be seen, in [m]."""

# Radius of the iiwa's shell at each link, in [m]: it tapers from shoulder to wrist.
_SHELL_RADIUS = (0.082, 0.080, 0.074, 0.072, 0.066, 0.062, 0.045)
_UNSEEN_BY_PHYSICS: dict[str, Any] = {"contype": 0, "conaffinity": 0, "group": 2, "mass": 0.0}


def player_color(number: int) -> Color:
    """The colour of player 1 (blue) or player 2 (green)."""
    return _PLAYERS[number - 1]


def add_base(body: Any, robot: RobotSpec, number: int) -> None:
    """The pedestal under the first joint, with a collar in the player's colour."""
    height = robot.links[0].position[2]
    add_pedestal(body, robot)
    _cylinder(body, (0, 0, 0.6 * height), (0, 0, height), 0.09, player_color(number))


def add_pedestal(body: Any, robot: RobotSpec) -> None:
    """What the arm stands on."""
    _cylinder(body, (0, 0, 0), (0, 0, 0.6 * robot.links[0].position[2]), 0.11, SHELL)


def add_link(body: Any, robot: RobotSpec, number: int, index: int) -> None:
    """A tube from this joint to the next one, and a ring about the joint's axis (iiwa only; planar links collide)."""
    if robot.universal_height is None:
        return
    radius = _SHELL_RADIUS[index - 1]
    add_tube(body, robot, index)
    _cylinder(body, (0, 0, -0.2 * radius), (0, 0, 0.2 * radius), 1.06 * radius, JOINT_RING if index % 2 else ROD)


def add_tube(body: Any, robot: RobotSpec, index: int) -> None:
    """A tube from this joint of the iiwa to the next one."""
    end = robot.links[index].position if index < robot.n_joints else (0.0, 0.0, 0.06)
    _cylinder(body, (0, 0, 0), end, 0.85 * _SHELL_RADIUS[index - 1], SHELL, capsule=True)


def add_tip(body: Any, robot: RobotSpec, number: int) -> None:
    """The iiwa's extension rod, drawn back from its tip towards the flange, and the universal joint."""
    if robot.universal_height is None:
        return
    add_rod(body, robot)
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(0.022, 0, 0), rgba=JOINT_RING, **_UNSEEN_BY_PHYSICS)


def add_rod(body: Any, robot: RobotSpec) -> None:
    """The iiwa's extension rod, in the frame of its tip."""
    _cylinder(body, (0, 0, -robot.tip[0].position[2] + 0.06), (0, 0, 0), 0.014, ROD)


def add_surroundings(spec: Any) -> None:
    """Light, cameras and the lines on the table."""
    light = spec.worldbody.add_light(
        pos=(-1.2, -1.6, 4), dir=(0.25, 0.35, -1), type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    )
    light.diffuse, light.specular = (0.55, 0.55, 0.53), (0.12, 0.12, 0.12)
    head = spec.visual.headlight
    head.ambient, head.diffuse, head.specular = (0.34, 0.35, 0.37), (0.26, 0.26, 0.26), (0.06, 0.06, 0.06)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1080
    spec.stat.extent, spec.stat.center = SCENE_EXTENT, (0, 0, 0.2)  # of what matters: the floor would blur every shadow
    _add_lines(spec.body("table_surface"))
    world = spec.worldbody
    world.add_camera(name="top", pos=(0, 0, 2.6), quat=(1, 0, 0, 0))
    world.add_camera(name="side", pos=(0, -2.5, 1.75), xyaxes=(1, 0, 0, 0, 0.58, 0.81))
    world.add_camera(name="home", pos=(-2.6, 0, 1.6), xyaxes=(0, -1, 0, 0.55, 0, 0.83))


def _add_lines(surface: Any) -> None:
    """Goal lines, middle line and centre circle: films of paint, each a little above the other."""
    box, disc = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER
    half_length, half_width, goal = TABLE.length / 2, TABLE.width / 2, TABLE.goal_width / 2
    paint = [
        (disc, (CIRCLE_RADIUS, PAINT, 0), (0, 0), LINE),
        (disc, (CIRCLE_RADIUS - 0.012, PAINT, 0), (0, 0), SURFACE),
        (box, (0.006, half_width, PAINT), (0, 0), LINE),
        (box, (0.004, goal, PAINT), (-half_length, 0), PUCK),
        (box, (0.004, goal, PAINT), (half_length, 0), PUCK),
    ]
    for layer, (kind, size, (x, y), rgba) in enumerate(paint):
        surface.add_geom(type=kind, size=size, pos=(x, y, layer * PAINT), rgba=rgba, **_UNSEEN_BY_PHYSICS)


def _cylinder(
    body: Any,
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    radius: float,
    rgba: Color,
    capsule: bool = False,
) -> None:
    kind = mujoco.mjtGeom.mjGEOM_CAPSULE if capsule else mujoco.mjtGeom.mjGEOM_CYLINDER
    body.add_geom(type=kind, fromto=(*start, *end), size=(radius, 0, 0), rgba=rgba, **_UNSEEN_BY_PHYSICS)
