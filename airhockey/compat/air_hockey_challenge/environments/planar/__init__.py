"""The planar robot's base environments, moved by torques."""

from .defend import AirHockeyDefend
from .hit import AirHockeyHit

__all__ = ["AirHockeyDefend", "AirHockeyHit"]
