"""What agents derive from and what they train in."""

from .agent_base import AgentBase
from .air_hockey_challenge_wrapper import AirHockeyChallengeWrapper
from .challenge_core import ChallengeCore

__all__ = ["AgentBase", "AirHockeyChallengeWrapper", "ChallengeCore"]
