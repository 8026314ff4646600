"""What an action looks like for each interpolation order, and the check that every action passes before the engine sees it."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.interpolation import WHOLE_TRAJECTORY
from airhockey.envs.specs import SUBSTEPS, RobotSpec
from airhockey.errors import ActionError, ConfigurationError

Array = NDArray[np.float64]
FLOAT = np.dtype(np.float64)

ORDERS: tuple[int | None, ...] = (1, 2, 3, 4, 5, -1, None)
"""Interpolation orders; `None` stands for actions that are whole trajectories of 20 set-points."""

_ROWS = {1: 1, 2: 1, 3: 2, 4: 2, 5: 3, -1: 2, None: 3 * SUBSTEPS}


class ActionFormat:
    """The actions of one robot.

    Attributes:
        order: The interpolation order.
        shape: (n,), (2, n), (3, n) or (20, 3, n), as the order asks.
        rows: The number of rows once flattened to (rows, n).
        code: The order as compiled code wants it.
    """

    def __init__(self, order: int | None, n_joints: int) -> None:
        if order not in ORDERS or isinstance(order, bool):
            raise ConfigurationError(f"unknown interpolation order {order!r}; allowed: 1, 2, 3, 4, 5, -1, None")
        self.order = order
        self.rows = _ROWS[order]
        self.code = WHOLE_TRAJECTORY if order is None else order
        self.shape: tuple[int, ...] = (self.rows, n_joints)
        if order is None:
            self.shape = (SUBSTEPS, 3, n_joints)
        elif self.rows == 1:
            self.shape = (n_joints,)

    def check(self, action: Any, step: int, player: str = "") -> Array:
        """The action as finite float64 of `shape`.

        Raises:
            ActionError: Not numbers, another shape, or not finite; the message names the step.
        """
        if (
            type(action) is np.ndarray
            and action.dtype == FLOAT
            and action.shape == self.shape
            and math.isfinite(np.vdot(action, action))  # only if all are; huge numbers are left to the checks below
        ):
            return action.copy()
        where = f"step {step}{player}"
        try:
            values = np.asarray(action)
        except (ValueError, TypeError) as error:
            raise ActionError(f"{where}: the action is not an array of numbers: {error}") from error
        if values.dtype.kind not in "fiu":
            raise ActionError(
                f"{where}: the action is of type {type(action).__name__} with dtype {values.dtype}; "
                f"return a float array of shape {self.shape}"
            )
        if values.shape != self.shape:
            raise ActionError(
                f"{where}: the action has shape {values.shape}; "
                f"with interpolation order {self.order} it must be {self.shape}"
            )
        if not np.isfinite(values).all():
            raise ActionError(f"{where}: the action holds values that are not finite; all must be numbers")
        return values.astype(np.float64)

    def limits(self, robot: RobotSpec) -> tuple[Array, Array]:
        """Lower and upper bounds of the action, each of `shape`: the limits of position, velocity and acceleration."""
        stacked = np.stack((robot.joint_position_limit, robot.joint_velocity_limit, robot.joint_acceleration_limit))
        if self.order is None:
            return np.tile(stacked[:, 0], (SUBSTEPS, 1, 1)), np.tile(stacked[:, 1], (SUBSTEPS, 1, 1))
        return stacked[: self.rows, 0].reshape(self.shape), stacked[: self.rows, 1].reshape(self.shape)
