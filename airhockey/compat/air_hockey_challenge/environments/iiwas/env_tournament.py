"""Two players."""

from airhockey.compat.base_environments import Tournament

from .env_double import AirHockeyDouble


class AirHockeyTournament(Tournament, AirHockeyDouble):
    """Two players."""

    _scene = "tournament"
