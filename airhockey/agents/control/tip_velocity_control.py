"""One control step of the rod tip: from the velocity that it should have at the end to a joint velocity within the limits.

Compiled as a whole, because an agent does it in every control step and plans by doing it many times.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.control.active_set import minimise
from airhockey.agents.control.aqp import VelocityLimits, exact_problem, is_singular, relaxed_problem
from airhockey.agents.control.braking import box_speeds, joint_speeds
from airhockey.agents.control.kinematics import chain_of, heights_and_jacobian, jacobian_of, locate
from airhockey.agents.control.parameters import ControlParameters
from airhockey.agents.control.speed_limit import largest_speed
from airhockey.agents.control.workspace import Workspace
from airhockey.envs.compiled import pack
from airhockey.envs.specs import RobotSpec

Array = NDArray[np.float64]


class StepModel(NamedTuple):
    """What a step is computed from; see `ControlParameters` for what is not said here.

    Attributes:
        offset, rotation, tip: The robot's links; see `airhockey.envs.compiled.SerialChain`.
        position_limit, velocity_limit: Lower and upper to keep, in [rad] and [rad]/[s]. Shapes (2, n).
        acceleration: Largest change of joint velocity per second, in [rad]/[s²]. Shape (n,).
        weights: Diagonal of W. Shape (n,).
        lower, upper: Corners of where the rod tip may be, in [m]. Shapes (2,).
        tip_acceleration: With which it keeps clear of the edges, in [m]/[s²].
        height: That it is commanded to, in [m].
        coordinates: How many of its coordinates the joints move, 2 or 3.
        dt: Length of a control step, in [s].
    """

    offset: Array
    rotation: Array
    tip: Array
    position_limit: Array
    velocity_limit: Array
    acceleration: Array
    weights: Array
    lower: Array
    upper: Array
    tip_acceleration: float
    height: float
    coordinates: int
    dt: float
    position_gain: float
    anchor_gain: float
    tracking_weight: float
    sideways_weight: float
    height_weight: float
    link_height: float
    link_height_gain: float


def step_model(spec: RobotSpec, p: ControlParameters, workspace: Workspace, dt: float) -> NDArray[Any]:
    """The model of a robot with these parameters, in this workspace; dt in [s].

    It is packed into a record of shape (1,), as which it costs little to hand over; `model[0]` has the fields of `StepModel`.
    """
    model = StepModel(
        **chain_of(spec)._asdict(),
        position_limit=p.position_share * spec.joint_position_limit,
        velocity_limit=p.velocity_share * spec.joint_velocity_limit,
        acceleration=p.acceleration_share * spec.joint_acceleration_limit[1],
        weights=np.array(p.anchor_weights),
        lower=workspace.lower,
        upper=workspace.upper,
        tip_acceleration=workspace.acceleration,
        height=spec.desired_height,
        coordinates=3 if spec.n_joints == 7 else 2,
        dt=dt,
        position_gain=p.position_gain,
        anchor_gain=p.anchor_gain,
        tracking_weight=p.tracking_weight,
        sideways_weight=p.sideways_weight,
        height_weight=p.height_weight,
        link_height=p.link_height,
        link_height_gain=p.link_height_gain,
    )
    return pack(model)


class Demand(NamedTuple):
    """What is asked of the joints in a step.

    Attributes:
        jacobian: Of the rod tip at the end of the step, without rows that vanish. Shape (m, n).
        velocity: That the rod tip should have there, in [m]/[s]. Shape (m,).
        anchor: Joint velocity towards the anchor, in [rad]/[s]. Shape (n,).
        limits: Of the joint velocity.
        edges: Least and largest velocity of the rod tip before the edges, in [m]/[s]. Shape (2, 2).
    """

    jacobian: Array
    velocity: Array
    anchor: Array
    limits: VelocityLimits
    edges: Array


@compiled
def tip_velocity_to(now: Array, target: Array, velocity: Array | None, packed: NDArray[Any]) -> Array:
    """The velocity with which the rod tip ends a step, so that it comes to a target. Shape (2,).

    Without a velocity: the way to the target over Δt (thesis). Ending the step with the target's velocity leaves an error, of
    which a share is removed (all of it in two steps at a gain of 1).

    Args:
        now: Position and velocity of the rod tip, in [m] and [m]/[s]. Shape (4,).
        target: In [m]; moved into the workspace first. Shape (2,).
        velocity: There, in [m]/[s]. Shape (2,).
        packed: From `step_model`.
    """
    model = packed[0]
    wanted = np.empty(2)
    for i in range(2):
        way = min(max(target[i], model.lower[i]), model.upper[i]) - now[i]
        if velocity is None:
            wanted[i] = way / model.dt
        else:
            error = way - 0.5 * model.dt * (now[2 + i] + velocity[i])
            wanted[i] = velocity[i] + model.position_gain * error / model.dt
    return wanted


@compiled
def demand(q: Array, joint_velocity: Array, tip_velocity: Array, anchor: Array, model: StepModel) -> Demand:
    """What is asked of the joints so that the rod tip ends a step with a velocity, as far as the edges allow.

    Args:
        q, joint_velocity: Now, in [rad] and [rad]/[s]. Shapes (n,).
        tip_velocity: In [m]/[s]. Shape (2,).
        anchor: Joint position that the null space is drawn to, in [rad]. Shape (n,).
        model: Of the step.
    """
    n, m, dt = len(q), model.coordinates, model.dt
    positions, axes = locate(model, q + dt * joint_velocity)  # the end of the step if the velocity lasts
    tip, whole = positions[n], jacobian_of(positions, axes, n)
    present = _times(whole, joint_velocity)
    edges = box_speeds(tip[:2] - 0.5 * dt * present[:2], model.lower, model.upper, model.tip_acceleration, dt)
    wanted = np.empty(m)
    for i in range(2):
        wanted[i] = min(max(tip_velocity[i], edges[0, i]), edges[1, i])
    if m == 3:  # half of the change of velocity moves the tip as well
        wanted[2] = model.position_gain * (model.height - tip[2] + 0.5 * dt * present[2]) / dt
    speeds = joint_speeds(q, joint_velocity, model.position_limit, model.velocity_limit, model.acceleration, dt)
    heights, rows = heights_and_jacobian(positions, axes)
    limits = VelocityLimits(speeds[0], speeds[1], rows, -model.link_height_gain * (heights - model.link_height))
    return Demand(whole[:m], wanted, model.anchor_gain * (anchor - q), limits, edges)


@compiled
def relaxed_demand(asked: Demand, model: StepModel) -> tuple[Demand, Array]:
    """The same, at a speed that the joints can reach, and held off the edges; and T, what each error counts. Shape (m, m).

    The rod tip slows down, so that direction is not traded for speed. Errors are weighed along the asked direction, across it,
    and vertically.
    """
    m, n = asked.jacobian.shape
    wanted, tracking, direction = asked.velocity.copy(), np.zeros((m, m)), np.zeros(m)
    for i in range(m):
        tracking[i, i] = model.tracking_weight * (model.height_weight if i == 2 else 1.0)
    speed = np.sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1])
    if speed > 1e-6:
        direction[0], direction[1] = wanted[0] / speed, wanted[1] / speed
        reachable = largest_speed(asked.jacobian, direction, model.velocity_limit[0], model.velocity_limit[1])
        share = min(1.0, reachable / speed)
        along = 1.0 - model.sideways_weight
        for i in range(2):
            wanted[i] *= share
            tracking[i, i] = model.tracking_weight * (model.sideways_weight + along * direction[i] * direction[i])
        tracking[0, 1] = tracking[1, 0] = model.tracking_weight * along * direction[0] * direction[1]
    limits, k = asked.limits, len(asked.limits.row_lower)
    rows, row_lower = np.empty((k + 4, n)), np.empty(k + 4)
    rows[:k], row_lower[:k] = limits.rows, limits.row_lower
    for i in range(2):
        rows[k + i], row_lower[k + i] = asked.jacobian[i], asked.edges[0, i]
        rows[k + 2 + i], row_lower[k + 2 + i] = -asked.jacobian[i], -asked.edges[1, i]
    inside = VelocityLimits(limits.lower, limits.upper, rows, row_lower)
    return Demand(asked.jacobian, wanted, asked.anchor, inside, asked.edges), tracking


@compiled
def joint_velocity_for(asked: Demand, model: StepModel) -> tuple[Array, bool]:
    """The joint velocity that does what is asked, or comes nearest to it; and whether it does so exactly. Shape (n,)."""
    if not is_singular(asked.jacobian):
        problem = exact_problem(asked.jacobian, asked.velocity, asked.anchor, asked.limits, model.weights)
        velocity, found = minimise(problem.hessian, problem.gradient, problem.rows, problem.lower, problem.upper)
        if found:
            return velocity, True
    soft, tracking = relaxed_demand(asked, model)
    for limits in (soft.limits, asked.limits):  # braking as hard as the joints can may not be enough for the edges
        problem = relaxed_problem(soft.jacobian, soft.velocity, soft.anchor, limits, tracking, model.weights)
        velocity, found = minimise(problem.hessian, problem.gradient, problem.rows, problem.lower, problem.upper)
        if found:
            return velocity, False
    return stopping(asked.limits), False


@compiled
def stopping(limits: VelocityLimits) -> Array:
    """Where only the height rows can contradict the box: keep the box, and stop. Shape (n,)."""
    return np.minimum(np.maximum(np.zeros(len(limits.lower)), limits.lower), limits.upper)


@compiled
def end_state(state: Array, new_velocity: Array, model: StepModel, after: Array) -> None:
    """Write the state after a step that ends with a joint velocity (4.1). Both as for `advance`. Shape (2 n + 4,)."""
    n = len(new_velocity)
    for i in range(n):
        after[i] = state[i] + 0.5 * model.dt * (state[n + i] + new_velocity[i])
        after[n + i] = new_velocity[i]
    positions, axes = locate(model, after[:n])
    moving = _times(jacobian_of(positions, axes, n), new_velocity)
    after[2 * n], after[2 * n + 1] = positions[n, 0], positions[n, 1]
    after[2 * n + 2], after[2 * n + 3] = moving[0], moving[1]


@compiled
def advance(state: Array, tip_velocity: Array, anchor: Array, packed: NDArray[Any], after: Array) -> bool:
    """One step whose end has a given tip velocity, as nearly as the limits allow.

    Args:
        state: Joint position, joint velocity, tip position, tip velocity. Shape (2 n + 4,).
        tip_velocity: In [m]/[s]. Shape (2,).
        anchor: Joint position that the null space is drawn to, in [rad]. Shape (n,).
        packed: From `step_model`.
        after: Where the state after it is written: to give an array back costs more. Shape (2 n + 4,).

    Returns:
        Whether it is what was asked, exactly.
    """
    model = packed[0]
    n = len(anchor)
    q, joint_velocity = state[:n], state[n : 2 * n]
    new_velocity, exact = joint_velocity_for(demand(q, joint_velocity, tip_velocity, anchor, model), model)
    end_state(state, new_velocity, model, after)
    return exact


@compiled
def advance_to(
    state: Array, target: Array, velocity: Array | None, anchor: Array, packed: NDArray[Any], after: Array
) -> bool:
    """One step towards a target, with the arguments of `tip_velocity_to` and `advance`: a single call of compiled code."""
    wanted = tip_velocity_to(state[len(state) - 4 :], target, velocity, packed)
    return advance(state, wanted, anchor, packed, after)


@compiled
def _times(matrix: Array, vector: Array) -> Array:
    """A 3-row matrix times a vector. Shape (3,)."""
    result = np.zeros(3)
    for i in range(3):
        for k in range(len(vector)):
            result[i] += matrix[i, k] * vector[k]
    return result
