"""The players' controller with other solvers and other kinematics: the same commands, chosen by a setting."""

import numpy as np
import pytest

from airhockey import envs
from airhockey.agents import build_agent
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.parameters import control_parameters
from airhockey.agents.control.pinocchio_model import PinocchioKinematics
from airhockey.agents.registry import AGENTS
from airhockey.agents.settings import settings_in_use
from airhockey.envs.specs import IIWA, PLANAR
from airhockey.errors import ConfigurationError, MissingDependencyError

CHOICES = ["control.solver=daqp", "control.solver=osqp", "control.kinematics=pinocchio"]


def commands(name: str, *settings: str, steps: int = 25) -> np.ndarray:
    env = envs.make(name)
    agent = AGENTS["planner"].build(env.env_info, settings=settings)
    agent.episode_start()
    observation, told = env.reset(seed=4), []
    for _ in range(steps):
        told.append(agent.draw_action(observation))
        observation, *_ = env.step(told[-1])
    return np.array(told)


@pytest.mark.parametrize("setting", CHOICES)
@pytest.mark.parametrize("name", ["7dof-hit", "3dof-defend"])
def test_a_choice_gives_the_same_commands(setting: str, name: str) -> None:
    np.testing.assert_allclose(commands(name, setting), commands(name), atol=2e-5)


@pytest.mark.parametrize("spec", [IIWA, PLANAR], ids=["iiwa", "planar"])
def test_pinocchio_is_what_computes(spec: object) -> None:
    theirs, ours = PinocchioKinematics(spec), ArmKinematics(spec)  # type: ignore[arg-type]
    for q in np.random.default_rng(1).uniform(-1.0, 1.0, (10, ours.n_joints)):
        for one, other in zip(theirs.position_and_jacobian(q), ours.position_and_jacobian(q), strict=True):
            np.testing.assert_allclose(one, other, atol=1e-12)
        np.testing.assert_allclose(theirs.rotation(q), ours.rotation(q), atol=1e-12)


def test_a_setting_is_for_who_is_built_meanwhile() -> None:
    with settings_in_use(["control.solver=osqp", "control.edge_margin=0.01"]):
        chosen = control_parameters(IIWA)
    assert (chosen.solver, chosen.edge_margin) == ("osqp", 0.01)
    assert control_parameters(IIWA).solver == "dual"
    assert build_agent("planner", envs.make("7dof-hit").env_info) is not None


@pytest.mark.parametrize("setting", ["solver=osqp", "control.solver", "control.nothing=1", "control.solver=simplex"])
def test_what_cannot_be_chosen_is_refused(setting: str) -> None:
    with pytest.raises(ConfigurationError, match=r"PART\.NAME=VALUE|QP solver|nothing"):
        AGENTS["planner"].build(envs.make("7dof-hit").env_info, settings=[setting])


@pytest.mark.parametrize(("setting", "module"), list(zip(CHOICES, ["daqp", "osqp", "pinocchio"], strict=True)))
def test_what_is_not_installed_names_the_extra(setting: str, module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, module, None)
    monkeypatch.delitem(__import__("sys").modules, "airhockey.agents.control.pinocchio_model", raising=False)
    with pytest.raises(MissingDependencyError, match=r"airhockey\[control\]"):
        AGENTS["planner"].build(envs.make("7dof-hit").env_info, settings=[setting])
