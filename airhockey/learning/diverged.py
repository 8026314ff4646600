"""What every way of training says when it went astray."""

from airhockey.errors import AirHockeyError


class DivergedError(AirHockeyError):
    """The training went astray; what it had before is kept."""
