"""`env_info` is what the official package hands to agents: compared with what was read off it, in every environment and order."""

import json
import pickle
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from airhockey import envs
from airhockey.envs.constraints import Constraint, ConstraintList

FACTS = json.loads((Path(__file__).parents[1] / "data" / "env_info_2023.json").read_text())
OFFICIAL = {name: {**group["common"], **own} for group in FACTS.values() for name, own in group["environments"].items()}
ORDERS = (1, 2, 3, 4, 5, -1, None)
OURS = {".rl_info": "airhockey.envs.info.RLInfo", ".constraints": "airhockey.envs.constraints.ConstraintList"}
"""Classes that are ours where the official package's is not installed: with it, and inside an entry, they are its own."""


def described(info: dict[str, Any]) -> dict[str, Any]:
    """Keys, types, shapes and values, in the notation of the facts; constraints and models by their public names."""
    told: dict[str, Any] = {}
    for key, value in info.items():
        describe(f".{key}", value, told)
    constraints, model = info["constraints"], info["robot"]["robot_model"]
    told["constraints keys"] = list(constraints.keys())
    for name in constraints.keys():  # noqa: SIM118 - as agents ask
        told[f"constr.{name}"] = [public for public in dir(constraints.get(name)) if not public.startswith("_")]
    kinds = ((mujoco.mjtObj.mjOBJ_BODY, model.nbody), (mujoco.mjtObj.mjOBJ_JOINT, model.njnt))
    kinds += ((mujoco.mjtObj.mjOBJ_GEOM, model.ngeom),)
    names = [[mujoco.mj_id2name(model, kind, k) or "" for k in range(count)] for kind, count in kinds]
    told["model"] = [model.nq, model.nv, model.nbody, *names]
    return told


def describe(path: str, value: Any, told: dict[str, Any]) -> None:
    kind = type(value)
    if kind is dict:
        for key, inner in value.items():
            describe(f"{path}.{key}", inner, told)
    elif kind is np.ndarray:
        told[path] = ["ndarray", list(value.shape), str(value.dtype), value.tolist()]
    elif kind is list and value and type(value[0]) is np.ndarray:
        told[path] = f"list[{len(value)}]"
        for k, inner in enumerate(value):
            describe(f"{path}[{k}]", inner, told)
    elif kind in (int, float, str, list):
        told[path] = [kind.__name__, value]
    else:
        told[path] = f"{kind.__module__}.{kind.__qualname__}"
        if path == ".rl_info":
            for space in ("observation_space", "action_space"):
                box = getattr(value, space)
                told[f"{path}.{space}"] = ["Box", list(box.shape), box.low.tolist(), box.high.tolist()]
            told |= {f"{path}.{name}": repr(getattr(value, name)) for name in ("gamma", "horizon", "dt", "shape")}
            told[f"{path}.size"] = "'ABSENT'" if not hasattr(value, "size") else repr(value.size)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", OFFICIAL)
def test_it_is_the_official_one_in_every_environment_and_order(name: str, order: int | None) -> None:
    told = described(envs.make(name, order).env_info)
    assert set(told) == set(OFFICIAL[name])
    for key, value in (OFFICIAL[name] | OURS).items():
        if value[0] in ("ndarray", "Box"):  # degrees become radians in another order: the last bit may differ
            assert told[key][:-2] == value[:-2] and np.shape(told[key][-1]) == np.shape(value[-1])
            for mine, theirs in zip(told[key], value, strict=True):
                assert mine == theirs or np.allclose(mine, theirs, rtol=1e-15, atol=0.0)
        else:
            assert told[key] == value, key


@pytest.mark.parametrize("name", OFFICIAL)
def test_the_wrappers_is_mushrooms(name: str) -> None:
    info = envs.AirHockeyChallengeWrapper(name).env_info["rl_info"]
    assert f"{type(info).__module__}.{type(info).__qualname__}" == OFFICIAL[name][".rl_info"]
    assert repr(info.shape) == OFFICIAL[name][".rl_info.shape"]


def test_rl_info_can_be_changed_copied_and_sent() -> None:
    info = envs.make("7dof-hit").env_info["rl_info"]
    other = info.copy()
    other.action_space.low[:] = 0.0
    other.gamma, other.horizon = 0.9, 10
    assert np.all(info.action_space.low < 0.0) and (info.gamma, info.horizon) == (0.99, 500)
    assert info.shape == (23, 14)
    assert pickle.loads(pickle.dumps(info)).shape == info.shape


@pytest.mark.parametrize(
    ("name", "height"), [("3dof-hit", 0.1), ("7dof-defend", 0.1645), ("tournament", 0.1645)], ids=str
)
def test_the_constraints_have_the_official_attributes(name: str, height: float) -> None:
    info = envs.make(name).env_info
    constraints, robot = info["constraints"], info["robot"]
    for key, limit in (("joint_pos_constr", "joint_pos_limit"), ("joint_vel_constr", "joint_vel_limit")):
        np.testing.assert_allclose(constraints.get(key).joint_limits, 0.95 * robot[limit], rtol=1e-15)
    tip = constraints.get("ee_constr")
    found = [tip.x_lb, tip.y_lb, tip.y_ub, tip.z_lb, tip.z_ub]
    np.testing.assert_allclose(found, [0.58415, -0.47085, 0.47085, height - 0.02, height + 0.02], atol=1e-12)
    assert tip.robot_model is tip.robot_model and tip.robot_model is not robot["robot_model"]
    assert tip.robot_data is tip.robot_data and tip.robot_model.nq == robot["n_joints"]
    if "3dof" not in name:
        assert constraints.get("link_constr").z_lb == 0.25
    assert constraints.get("no_constr") is None


def test_a_constraint_of_ones_own_joins_the_list() -> None:
    class Slow(Constraint):
        _name = "slow_constr"

        def _fun(self, q: Any, dq: Any) -> Any:
            return np.array([dq @ dq - 1.0])

        def _jacobian(self, q: Any, dq: Any) -> Any:
            return np.concatenate((0.0 * q, 2.0 * dq))[None]

    info = envs.make("7dof-defend").env_info
    several = ConstraintList()
    several.add(info["constraints"].get("ee_constr"))
    several.add(Slow(info, 1))
    q, dq = np.zeros(7), np.linspace(0.0, 1.0, 7)
    assert list(several.fun(q, dq)) == ["ee_constr", "slow_constr"]
    assert several.jacobian(q, dq)["slow_constr"].shape == (1, 14)
    assert several.fun(q, dq)["slow_constr"][0] == pytest.approx(dq @ dq - 1.0)
    several.delete("ee_constr")
    assert list(several.keys()) == ["slow_constr"]
