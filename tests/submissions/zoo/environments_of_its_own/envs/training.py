import numpy as np
from air_hockey_challenge.environments.iiwas.env_single import AirHockeySingle
from air_hockey_challenge.environments.planar.single import AirHockeySingle as PlanarSingle
from air_hockey_challenge.environments.position_control_wrapper import IiwaPositionDefend, PositionControlIIWA
from air_hockey_challenge.framework.challenge_core import ChallengeCore
from air_hockey_challenge.framework.evaluate_agent import evaluate
from air_hockey_challenge.utils.tournament_agent_wrapper import SimpleTournamentAgentWrapper

__all__ = ["ChallengeCore", "Drill", "PlanarSingle", "PositionedDrill", "SimpleTournamentAgentWrapper", "evaluate"]


class Drill(AirHockeySingle):
    def setup(self, obs):
        super().setup(obs)
        self._write_data("puck_x_pos", -0.5)
        self._write_data("puck_y_pos", np.random.uniform(-0.3, 0.3))

    def reward(self, state, action, next_state, absorbing):
        return float(next_state[0])


class PositionedDrill(PositionControlIIWA, Drill):
    pass


assert issubclass(IiwaPositionDefend, PositionControlIIWA)
