"""Where each skill is trained, and what shapes its reward besides the thesis's own (4.9)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.features import HORIZON, LINE, crossing
from airhockey.agents.atacom.skill import DEFEND, HOME_SKILL
from airhockey.agents.estimation.motion import puck_motion
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, HALF_LENGTH, HOME, to_table
from airhockey.envs.gymnasium import AirHockeyEnv
from airhockey.envs.tasks import reward_for
from airhockey.learning.sac.skill_env import SkillEnv

Array = NDArray[np.float64]


class DefendEnv(SkillEnv):
    """The task *defend*: (4.9), a potential of the distance to where the puck will cross, and calm at the end."""

    NEARNESS, CALM, DISCOUNT = 4.0, 2.0, 0.98

    def __init__(self, robot: str, disturbances: Any = "ideal") -> None:
        super().__init__(
            AirHockeyEnv(f"{robot}-defend", disturbances=disturbances, reward=reward_for("defend")), DEFEND
        )
        self._constants = puck_motion().constants

    def shaping(self, before: Situation, after: Situation) -> float:
        """γ Φ(after) − Φ(before), Φ = −4 |y_crossing − y_tip|."""
        return self.DISCOUNT * self._nearness(after) - self._nearness(before)

    def conclude(self, seen: Situation) -> tuple[bool, float]:
        """The task is played to its end at rest; the speed that was left to the puck costs 2 per [m]/[s], up to 4."""
        self.rest()
        return self._success, -self.CALM * min(float(np.hypot(seen.puck.state[2], seen.puck.state[3])), 2.0)

    def _nearness(self, now: Situation) -> float:
        y = (
            crossing(now.puck.state, LINE, HORIZON, self._constants)[1]
            if now.puck.state[0] > LINE
            else now.puck.state[1]
        )
        return -self.NEARNESS * abs(float(y - now.tip[1]))


class HomeEnv(SkillEnv):
    """The way home from anywhere, with a puck lying about: its length costs, and so does touching the puck.

    The start is where random actions of ATACOM lead from the start posture, in motion.
    """

    LONGEST, ARRIVAL, TOUCH, NEAR = 75, 2.0, 1.0, 0.1

    def __init__(self, robot: str, disturbances: Any = "ideal") -> None:
        super().__init__(AirHockeyEnv(f"{robot}-hit", disturbances=disturbances), HOME_SKILL)

    def begin(self, observation: Array, seed: Any) -> Array:
        """A random posture, clear of the puck."""
        entropy = seed if isinstance(seed, np.random.SeedSequence) else np.random.SeedSequence(seed)
        random = np.random.default_rng([*entropy.generate_state(2)])
        puck = to_table(observation[self._info["puck_pos_ids"]])
        for _ in range(20):
            self._wander(random)
            if np.hypot(*(puck - to_table(self.controller.tip))) > CONTACT + 0.03:
                break
        state, n = self._environment.base_observation, self.controller.q.size
        state[6 : 6 + n], state[6 + n : 6 + 2 * n] = self.controller.q, self.controller.velocity
        return self._environment.reset(state=state)

    def shaping(self, before: Situation, after: Situation) -> float:
        """−‖way‖ − 0.2 min(1, ‖way‖ / 0.1 m) for every action, and −1 while the mallet touches the puck."""
        gap, way = (float(np.hypot(*(point - after.tip))) for point in (after.puck.position, HOME))
        return -way - 0.2 * min(1.0, way / self.NEAR) - self.TOUCH * (gap - CONTACT < 0.005)

    def conclude(self, seen: Situation) -> tuple[bool, float]:
        """A success is to arrive with the puck still on the table."""
        on_table = abs(float(seen.puck.state[0])) < HALF_LENGTH
        arrived = HOME_SKILL.finished(seen) and on_table
        return arrived, self.ARRIVAL * arrived - 5.0 * (not on_table)

    def _wander(self, random: np.random.Generator) -> None:
        self.controller.reset(np.array(self.controller.spec.start))
        for _ in range(random.integers(1, 6)):
            action = random.uniform(-1.0, 1.0, 2)
            for _ in range(12):
                self.controller.step(action)


TASKS: dict[str, type[DefendEnv] | type[HomeEnv]] = {"defend": DefendEnv, "home": HomeEnv}
