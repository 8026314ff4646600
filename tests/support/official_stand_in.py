"""A stand-in for the official package of 2023, from its interfaces alone: it builds an agent and lets it play to a recording.

    python official_stand_in.py SUBMISSION RECORDING ENVIRONMENT [STEPS]

`env_info` is what the official package was seen to hand over (tests/data/env_info_2023.json), with classes of this file where it
has its own. The loop is the official core's: `episode_start`, then `draw_action`. Nothing here is airhockey's, but
for MuJoCo's model of the arm.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

FACTS = Path(__file__).parents[1] / "data" / "env_info_2023.json"


class Box:
    """MushroomRL's, as far as agents see it."""

    def __init__(self, low: Any, high: Any) -> None:
        self.low, self.high, self.shape = np.array(low), np.array(high), np.shape(low)


class MDPInfo:
    """MushroomRL's, as far as agents see it."""

    def __init__(self, observation_space: Box, action_space: Box, gamma: float, horizon: int, dt: float) -> None:
        self.observation_space, self.action_space = observation_space, action_space
        self.gamma, self.horizon, self.dt = gamma, horizon, dt
        self.shape = observation_space.shape + action_space.shape


class ConstraintList:
    """The official list, without constraints: agents that are handed in here bring their own."""

    constraints: dict[str, Any] = {}  # noqa: RUF012

    def keys(self) -> Any:
        return self.constraints.keys()


def facts_of(name: str) -> dict[str, Any]:
    """What was read off the official package in one environment."""
    group = next(group for group in json.loads(FACTS.read_text()).values() if name in group["environments"])
    return {**group["common"], **group["environments"][name]}


def env_info_of(name: str) -> dict[str, Any]:
    """The official `env_info` of an environment."""
    from airhockey.envs import scene
    from airhockey.envs.specs import IIWA, PLANAR

    facts, info = facts_of(name), dict[str, Any]()
    for path, value in facts.items():
        if path.startswith(".") and isinstance(value, list) and value[0] in ("int", "float", "str", "list", "ndarray"):
            put(info, path[1:].split("."), np.array(value[3]) if value[0] == "ndarray" else value[1])
    frames = [info["robot"].pop(f"base_frame[{k}]") for k in range(info["n_agents"])]
    model = scene.robot_model(PLANAR if info["robot"]["n_joints"] == 3 else IIWA)
    info["robot"] |= {"base_frame": frames, "robot_model": model, "robot_data": mujoco.MjData(model)}
    seen, done = (Box(*facts[f".rl_info.{space}_space"][2:]) for space in ("observation", "action"))
    info["rl_info"] = MDPInfo(seen, done, 0.99, int(facts[".rl_info.horizon"]), 0.02)
    info["constraints"] = ConstraintList()
    return info


def put(info: dict[str, Any], path: list[str], value: Any) -> None:
    for key in path[:-1]:
        info = info.setdefault(key, {})
    info[path[-1]] = value


def main() -> None:
    submission, recording, name, *more = sys.argv[1:]
    sys.path.insert(0, submission)
    from air_hockey_agent.agent_builder import build_agent  # type: ignore[import-not-found]

    agent = build_agent(env_info_of(name))
    observations = np.load(recording)["obs"][: int(more[0]) if more else 20]
    width = facts_of(name)[".rl_info.observation_space"][1][0]
    agent.episode_start()
    agent.next_action = None
    began = time.perf_counter()
    for observation in observations:
        for preprocessor in agent.preprocessors:
            observation = preprocessor(observation)
        action = np.asarray(agent.draw_action(observation[:width].copy()))
        assert action.shape == (2, agent.env_info["robot"]["n_joints"]) and np.isfinite(action).all(), action
    agent.stop()
    seconds = (time.perf_counter() - began) / len(observations)
    print(f"played {len(observations)} steps of {name}, {seconds * 1e3:.1f} ms each, with NumPy {np.__version__}")


if __name__ == "__main__":
    main()
