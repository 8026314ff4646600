"""A plant that differs from its model: masses, friction, rod length and rims, drawn anew for every episode."""

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from airhockey.envs.copying import Copyable
from airhockey.envs.disturbances import Mismatch
from airhockey.envs.specs import RobotSpec

_FIELDS = ("body_mass", "body_inertia", "body_pos", "dof_damping", "dof_frictionloss", "geom_solref")

Plant = dict[str, NDArray[np.float64]]
"""An episode's values of those fields of the model."""


class PlantMismatch(Copyable):
    """Changes a compiled scene in place; the nominal values are kept, so that draws do not accumulate.

    Args:
        model: The scene. The robot-only model, which controller and agents use, is another one and stays nominal.
        robot: The arm in it.
        n_robots: How many there are.
    """

    def __init__(self, model: mujoco.MjModel, robot: RobotSpec, n_robots: int) -> None:
        self._model = model
        self._perturbed = False
        self._scratch: Any = None
        self._nominal = {field: getattr(model, field).copy() for field in _FIELDS}
        names = [f"{robot.prefix}_{number}" for number in range(1, n_robots + 1)]
        self._links = np.array(
            [model.body(f"{name}/{robot.link_prefix}_{k + 1}").id for name in names for k in range(robot.n_joints)]
        )
        self._joints = np.array(
            [model.joint(f"{name}/joint_{k + 1}").dofadr[0] for name in names for k in range(robot.n_joints)]
        )
        self._rods = [model.body(f"{name}/{robot.tip[0].name}").id for name in names]
        self._rims = [g for g in range(model.ngeom) if model.geom(g).name.startswith("rim_")]

    def apply(self, mismatch: Mismatch, random: np.random.Generator) -> None:
        """Draw an episode's plant.

        The rod is longer or shorter along its own direction; a link's inertia changes with its mass.
        """
        if mismatch == Mismatch():
            return  # the compiled model to the last bit: `mj_setConst` rounds differently from the compiler
        model = self._model
        for field, values in self._nominal.items():
            getattr(model, field)[:] = values
        factors = random.uniform(*mismatch.mass, self._links.size)
        model.body_mass[self._links] *= factors
        model.body_inertia[self._links] *= factors[:, None]
        friction = random.uniform(*mismatch.joint_friction, self._joints.size)
        model.dof_damping[self._joints] *= friction
        model.dof_frictionloss[self._joints] *= friction
        for rod in self._rods:
            offset = self._nominal["body_pos"][rod]
            model.body_pos[rod] = offset * (1.0 + random.normal(0.0, mismatch.rod_length) / np.linalg.norm(offset))
        model.geom_solref[self._rims, 1] *= random.uniform(*mismatch.rim_damping)
        model.dof_damping[-3:] *= random.uniform(*mismatch.puck_damping)
        self._settle()

    def save(self) -> Plant | None:
        """The episode's plant, or None for the nominal one."""
        return {field: getattr(self._model, field).copy() for field in _FIELDS} if self._perturbed else None

    def restore(self, plant: Plant | None) -> None:
        """Go back to an episode's plant."""
        if plant is None and not self._perturbed:
            return
        for field, values in (self._nominal if plant is None else plant).items():
            getattr(self._model, field)[:] = values
        self._settle()

    def _settle(self) -> None:
        """Derive what MuJoCo keeps of masses and inertias."""
        self._perturbed = True
        if self._scratch is None:
            self._scratch = mujoco.MjData(self._model)
        mujoco.mj_setConst(self._model, self._scratch)

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_scratch": None}
