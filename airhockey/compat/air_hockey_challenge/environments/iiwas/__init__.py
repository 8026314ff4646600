"""The iiwa's base environments, moved by torques."""

from .env_defend import AirHockeyDefend
from .env_hit import AirHockeyHit
from .env_prepare import AirHockeyPrepare
from .env_tournament import AirHockeyTournament

__all__ = ["AirHockeyDefend", "AirHockeyHit", "AirHockeyPrepare", "AirHockeyTournament"]
