"""The base environments by their official names, with torques (`iiwas`, `planar`) and with set-points."""

from .position_control_wrapper import (
    IiwaPositionDefend,
    IiwaPositionHit,
    IiwaPositionPrepare,
    IiwaPositionTournament,
    PlanarPositionDefend,
    PlanarPositionHit,
)

__all__ = [
    "IiwaPositionDefend",
    "IiwaPositionHit",
    "IiwaPositionPrepare",
    "IiwaPositionTournament",
    "PlanarPositionDefend",
    "PlanarPositionHit",
]
