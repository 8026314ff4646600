"""What can be tuned about the planner's hit: `smash_iiwa.yaml` and `smash_planar.yaml` beside this module."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from airhockey.agents.parameters import load_parameters
from airhockey.envs.specs import RobotSpec


@dataclass(frozen=True)
class SmashParameters:
    """Parameters of the hit.

    Attributes:
        gain: g = 1 + e of the contact between mallet and puck.
        gain_slow: Added to it for slow strokes, divided by the mallet's speed, in [m]/[s].
        drift_kept: Share of the puck's lateral velocity that counts: the contact is soft, and while it lasts the mallet grips.
        spin_share: Share of the puck's surface velocity rω that becomes lateral velocity in a contact.
        turn: By which share of its sine a strike is commanded further from the x axis: the arm's systematic error.
        speed_places: x of the contact, in the table frame, in [m], ascending.
        speeds: Mallet speed that the arm reaches there, in [m]/[s]; linear between the places.
        diagonal: By what share a stroke across is faster than one along x: times the square of its direction's sine.
        fastest: No stroke is faster, in [m]/[s].
        brisk: Speed of the puck up to which a shot at full pace is worth more, the faster it is, in [m]/[s]; 0: it is not.
        sudden: Time after the last bounce down to which such a shot at the post on that side is worth more, in [s].
        least_speed: Below this no stroke is worth it, in [m]/[s].
        acceleration, braking: Of the mallet in a stroke, in [m]/[s²].
        steady: Time at full speed before the contact, in [s].
        follow: Time at full speed after it, in [s].
        farthest: Largest x that the mallet may reach in a stroke, in the table frame, in [m].
        edge: Distance that a stroke keeps from the edges of the workspace, in [m].
        direction_spread: Standard deviation of the direction of a struck puck, in [rad].
        bounce_spread: What a wall adds to it, in [rad].
        timing_spread: Standard deviation of the time at which the puck passes the opponent, in [s].
        goal_half_width: |y| of the puck's centre up to which it goes in, in [m].
        mouth_margin: Beside our own goal's mouth, how near to its posts the puck must not be waited for, in [m].
        patience: Loss of value per second of waiting, in [1/s].
        longest_wait: How far ahead a strike is planned, in [s].
        flight: Time that is kept for the puck's flight at the end of an episode, in [s].
        least_value: Probability of a goal below which there is no shot.
        least_value_in_game: The same in a tournament, where the opponent defends itself and the puck must be played in time.
        opponent_doubt: Standard deviation of where an opponent will be that does not swing regularly, in [m].
        improvement: By how much the value of another plan must be better than the one pursued.
        candidates: Shots that are tried per control step.
        approach_speed: Of the mallet on its way behind the puck, in [m]/[s].
        approach_acceleration: In [m]/[s²].
        approach_margin: Added to the estimated time of that way, in [s].
        clearance: Gap between mallet and puck that is kept on the way, in [m].
        posture: That the joints are drawn to while a shot is pursued, in [rad]; empty: the usual one.
        posture_gain: How fast, in [1/s].
    """

    gain: float
    drift_kept: float
    spin_share: float
    turn: float
    speed_places: tuple[float, ...]
    speeds: tuple[float, ...]
    least_speed: float
    acceleration: float
    braking: float
    steady: float
    follow: float
    farthest: float
    edge: float
    direction_spread: float
    bounce_spread: float
    timing_spread: float
    goal_half_width: float
    mouth_margin: float
    patience: float
    longest_wait: float
    flight: float
    least_value: float
    least_value_in_game: float
    opponent_doubt: float
    improvement: float
    candidates: int
    approach_speed: float
    approach_acceleration: float
    approach_margin: float
    clearance: float
    diagonal: float = 0.0
    fastest: float = 10.0
    brisk: float = 0.0
    sudden: float = 0.35
    gain_slow: float = 0.0
    posture: tuple[float, ...] = ()
    posture_gain: float = 0.0


@cache
def smash_parameters(spec: RobotSpec, in_game: bool = False) -> SmashParameters:
    """The package's parameters for a robot, in a task or in a game."""
    name = "smash_planar" if spec.n_joints != 7 else "smash_game" if in_game else "smash_iiwa"
    return load_parameters(SmashParameters, name, Path(__file__).parent)
