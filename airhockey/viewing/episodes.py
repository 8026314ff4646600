"""Recordings of episodes of tasks, made of what an agent observed."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import DEFAULT, ROBOTS, edition
from airhockey.envs.rendering.scene_view import SceneView
from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.viewing.caption import Caption
from airhockey.viewing.recording import Moment, Recording

Array = NDArray[np.float64]
ACHIEVED = {"hit": ("goal", "goal"), "defend": ("save", "puck stopped"), "prepare": ("prepared", "puck in reach")}
"""Kind of the moment, and what is said, where a task succeeds; by the kind of its environment."""
CONSTRAINTS = "constraints/"


@dataclass(frozen=True)
class Outcome:
    """How an episode ended, as far as it is known.

    Attributes:
        success: Whether the task was achieved; None where nobody recorded it.
        error: Why the agent failed.
    """

    success: bool | None = None
    error: str | None = None


@dataclass(frozen=True)
class EpisodeNarrator:
    """Captions of an episode.

    Attributes:
        title, player: Said all the time.
        steps: Of the episode.
        ending: Said at its end.
        violated: Names of the constraints violated at each step. Length: steps.
    """

    title: str
    player: str
    steps: int
    ending: str
    violated: list[str]

    def caption(self, step: int) -> Caption:
        """See `Narrator`."""
        return Caption(
            self.title,
            (self.player,),
            step * CONTROL_PERIOD,
            news=self.ending if step >= self.steps else "",
            alarm=self.violated[step - 1] if 0 < step <= len(self.violated) else "",
        )


def episode_recording(
    name: str,
    env: str,
    player: str,
    trajectory: Mapping[str, Array],
    outcome: Outcome,
    title: str = "",
    year: str = DEFAULT,
) -> Recording:
    """What an agent saw of an episode, as a recording.

    Args:
        name: What the recording is called.
        env: The environment.
        player: Who played.
        trajectory: `true_observations` or `observations` (T + 1, d), in the robot frame; `constraints/…` if there are any.
        outcome: How it ended.
        title: One line; made of the name where it is empty.
        year: The edition of the environment.
    """
    seen = np.asarray(trajectory["true_observations" if "true_observations" in trajectory else "observations"])
    rules = edition(year).environment(env)
    robot = ROBOTS[rules.robot]
    n, steps = robot.n_joints, len(seen) - 1
    base = np.array(robot.base_positions[0])
    puck = seen[:, :3] + [base[0], base[1], 0.0]
    joints = seen[:, None, 6 : 6 + n]
    if rules.robots == 2:
        tips = seen[:, 6 + 2 * n : 9 + 2 * n] + base
        joints = np.concatenate([joints, SceneView(env, year).follow_tips(1, tips)[:, None]], axis=1)
    values = {key.removeprefix(CONSTRAINTS): a for key, a in trajectory.items() if key.startswith(CONSTRAINTS)}
    what, ending = _ending(rules.kind, outcome)
    moments = violations(values, 0)
    if what:
        moments.append(Moment(steps, what, 0 if what in ("save", "goal", "prepared") else None, ending))
    narrator = EpisodeNarrator(title or f"{env}, episode {name}", player, steps, ending, violated_names(values, steps))
    moments.sort(key=lambda moment: moment.step)
    return Recording(name, narrator.title, env, puck, seen[:, 3:6], joints, narrator, tuple(moments), edition=year)


def violations(values: Mapping[str, Array], who: int) -> list[Moment]:
    """A moment wherever a constraint begins to be violated.

    Args:
        values: Constraint name -> its values at every step, violated where > 0. Each of shape (T, c).
        who: Whose they are.
    """
    moments = []
    for name, value in values.items():
        violated = np.asarray((value > 0.0).any(axis=1))
        begins = np.flatnonzero(violated & ~np.concatenate([[False], violated[:-1]]))
        moments += [Moment(int(k) + 1, "violation", who, name) for k in begins]
    return moments


def violated_names(values: Mapping[str, Array], steps: int) -> list[str]:
    """The constraints violated at each step, as text. Length: steps."""
    names = [""] * steps
    for name, value in values.items():
        for k in np.flatnonzero((value > 0.0).any(axis=1))[:steps]:
            names[k] = f"{names[k]}, {name}" if names[k] else f"violates {name}"
    return names


def _ending(kind: str, outcome: Outcome) -> tuple[str, str]:
    """Kind of the last moment and what is said about it; empty where nothing is known."""
    if outcome.error is not None:
        return "forfeit", f"the agent failed: {outcome.error}"
    if outcome.success is None:
        return "", ""
    achieved, said = ACHIEVED[kind]
    return (achieved, said) if outcome.success else ("missed", "not achieved")
