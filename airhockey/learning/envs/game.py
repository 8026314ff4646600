"""Whole games for a learner: player 1 learns, player 2 is any agent, and every serve is an episode.

vec = gymnasium.make_vec("airhockey/tournament-tip-v0", num_envs=8, opponents=["planner", "runs/mine"])

Actions and observations are those of the tasks (`airhockey.agents.learned`), save that an action lasts for one control step and
that feature 16 is the share of time that is left until a fault. The reward is the sum of named terms, weighted by a file:

| term | when | weight in game.yaml |
|---|---|---|
| goal | the puck is in the opponent's goal | 2/3 |
| conceded | it is in ours | −1 |
| fault | it stayed on our side for too long | −1/3 |
| opponents_fault | it stayed on the opponent's | 0 |
| penalty | a control step in which our robot violated a constraint | −0.01 |
"""

import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.base import AgentBase
from airhockey.agents.build import build_agent
from airhockey.agents.learned.actions import command, take_position
from airhockey.agents.learned.features import see, write
from airhockey.envs.tasks.game import HOME
from airhockey.envs.tasks.verdicts import FAULT_AWAY, FAULT_HOME, GOAL_AWAY, GOAL_HOME
from airhockey.envs.vector.environment import Batch
from airhockey.envs.vector.stepping import step_many
from airhockey.errors import ConfigurationError, unknown
from airhockey.inputs.plain_yaml import read_yaml
from airhockey.learning.envs.batch import LearningBatch

Array = NDArray[np.float64]

WEIGHTS = pathlib.Path(__file__).with_name("game.yaml")
EVENTS = {"goal": GOAL_HOME, "conceded": GOAL_AWAY, "fault": FAULT_HOME, "opponents_fault": FAULT_AWAY}
"""Terms that are a referee's verdict."""
TERMS = (*EVENTS, "penalty")
_ROWS = 2
"""Positions and velocities: an action of interpolation order 3."""


def read_weights(path: str | pathlib.Path) -> dict[str, float]:
    """The weight of every term.

    Raises:
        ConfigurationError: The file cannot be read; a term is missing, unknown or no number.
    """
    read = read_yaml(path)
    if not isinstance(read, Mapping) or set(read) != set(TERMS):
        raise ConfigurationError(f"{path} must give a weight to each of {', '.join(TERMS)}, and to nothing else")
    for name, weight in read.items():
        if isinstance(weight, bool) or not isinstance(weight, (int, float)) or not np.isfinite(weight):
            raise ConfigurationError(f"{path}: the weight of {name} is {weight!r}; give a finite number")
    return {name: float(read[name]) for name in TERMS}


class GameBatch(LearningBatch):
    """N games of the tournament, of which player 1 is the learner's.

    Args:
        num_envs, actions, observations, discount, disturbances, edition_name, threads, seed: See `LearningBatch`.
        opponents: Names or folders of agents, of which game i has number i modulo their count.
        weights: File of the rewards' weights.

    Attributes:
        opponents: Player 2 of each game; see `replace_opponent`.
        weights: Term → weight.
        terms: Of the latest step: term → 1 where it happened. Shapes (N,).
    """

    opponents: list[Any]
    _next: list[AgentBase | None]

    def __init__(
        self,
        num_envs: int,
        opponents: Sequence[str | pathlib.Path] = ("planner",),
        weights: str | pathlib.Path = WEIGHTS,
        **choice: Any,
    ) -> None:
        if isinstance(opponents, (str, pathlib.Path)) or not opponents:
            raise ConfigurationError(f"opponents are a list of agents, as in ['planner'], not {opponents!r}")
        for name in ("repeat", "reward"):
            if name in choice:
                raise unknown("choice for games", name, ("actions", "observations", "opponents", "weights"))
        self.weights, self._names = read_weights(weights), list(opponents)
        self.terms = dict[str, Array]()
        super().__init__("tournament", num_envs, repeat=1, **choice)

    @property
    def constraint_slices(self) -> dict[str, slice]:
        """See `VectorEnvironment`; those of the learner's own robot."""
        return self.single.constraint_slices

    def replace_opponent(self, i: int, agent: str | pathlib.Path | AgentBase) -> None:
        """Have another player 2 in game i from its next serve on: so a league draws from its pool."""
        if not isinstance(agent, AgentBase):
            agent = build_agent(agent, self.single.env_info, agent_id=2)
        if agent.interpolation_order != 3:
            raise ConfigurationError(
                f"an opponent here must have interpolation order 3, not {agent.interpolation_order}; choose another agent"
            )
        self._next[i] = agent

    def new_batch(self) -> Batch:
        """See `VectorEnvironment`."""
        return super().new_batch()._replace(rewards=np.zeros(self.num_envs))

    def __getstate__(self) -> dict[str, Any]:
        """A copy's opponents are those of now, rather than built from folders that may have changed."""
        return super().__getstate__() | {"_names": list(self.opponents)}

    def get_state(self) -> Any:
        """See `LearningBatch`."""
        players = [one.copy() for one in self.opponents], [one and one.copy() for one in self._next]
        return super().get_state(), players

    def set_state(self, state: Any) -> None:
        """See `LearningBatch`."""
        batch, (present, coming) = state
        super().set_state(batch)
        self.opponents, self._next = [one.copy() for one in present], [one and one.copy() for one in coming]

    def _prepare(self) -> None:
        n = self.num_envs
        self._prepare_learner()
        self._width = self.learner.raw.shape[1] // 2
        self.terms = self.terms or {name: np.zeros(n) for name in TERMS}
        self.opponents, self._next = [None] * n, [None] * n
        for i in range(n):
            self.replace_opponent(i, self._names[i % len(self._names)])

    @property
    def observation_width(self) -> int:
        """Length of an observation."""
        return self._features.shape[1] or self.learner.raw.shape[1] // 2

    def _run(self, observations: Any) -> None:
        fleet, learner = self.fleet, self.learner
        self._steps += 1
        self._game_steps += 1
        for i, opponent in enumerate(self.opponents):
            fleet.actions[i, 1, :_ROWS] = opponent.draw_action(learner.raw[i, self._width :].copy())
            command(learner.controls, i, self._given[i], fleet.actions[i, 0])
        self._threads.run(step_many, fleet, learner.raw, self._counter)
        for i in range(self.num_envs):
            observations[i] = self._look(i, False)
        learner.played[:] += 1
        own = slice(learner.constraints[0], sum(learner.constraints) // 2)
        self.terms["penalty"][:] = (fleet.left[:, own] > 0.0).any(axis=1)
        learner.violated[:] += self.terms["penalty"].astype(np.int64)

    def _look(self, i: int, first: bool) -> Any:
        """What the learner observes of game i."""
        learner = self.learner
        seen = learner.raw[i, : self._width]
        see(learner.sights, learner.controls, i, seen, first)
        if not self._features.size:
            return seen
        rules = self.fleet.referees[i]
        ours = rules["side"][0] < 0
        left = 1.0 - float(rules["timer"][0] / rules["fault_time"]) if ours else 1.0
        write(learner.sights, learner.controls, i, left, self._features[i])
        return self._features[i]

    def _reward(self, batch: Batch, score: Any) -> None:
        for name, verdict in EVENTS.items():
            self.terms[name][:] = batch.verdicts == verdict
        batch.rewards[:] = sum(weight * self.terms[name] for name, weight in self.weights.items())
        batch.success[:] = self.fleet.referees["score"][:, HOME] > self.fleet.referees["score"][:, 1 - HOME]

    def _first(self, i: int, observation: Array) -> Any:
        self.opponents[i], self._next[i] = self._next[i] or self.opponents[i], None
        self.opponents[i].episode_start()
        learner, n = self.learner, self.learner.controls.q.shape[1]
        learner.raw[i] = observation
        joints = self.single.env_info["joint_pos_ids"]
        take_position(learner.controls, i, observation[joints[0] : joints[0] + n])
        return self._look(i, True)
