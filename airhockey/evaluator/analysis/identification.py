"""Disturbances read off recorded observations: noise, per-episode bias of the joints, lost tracks of the puck and delay.

An observation is the truth with noise of its own at every step. Between steps of 20 ms the truth moves almost evenly, so that a
difference of an order k, which takes out a polynomial of the degree k − 1, leaves the noise times √C(2k, k). Its spread is taken
from the median, which bounces, hits and hard accelerations do not reach.
"""

from collections.abc import Callable, Iterable, Sequence
from math import comb, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.disturbances import Disturbances, JointNoise, OpponentNoise, PuckNoise, TrackLoss
from airhockey.errors import ConfigurationError

Array = NDArray[np.float64]

ORDERS = {"puck": 2, "joints": 4, "opponent": 4}
"""Order of the differences: a puck slides evenly, an arm accelerates."""
NORMAL = 0.6744897501960817
"""Median absolute value of a standard normal variable."""
FLOORS = {"position": 2e-5, "yaw": 2e-4, "velocity": 2e-4, "yaw_rate": 2e-3}
"""Below this, in the profile's units, the motion itself explains the differences."""
MOVING = 0.05
"""Speed of the puck, in [m/s], at which an observation that is repeated is a lost track even where there is no noise."""
LEAST, PARTS = 200, 10
"""Values without which nothing is said, and parts of the data whose results tell the uncertainty."""
LONGEST_DELAY = 10
"""In control steps."""
FOLLOWING = 4
"""Losses of the track, one right after the other, that are thought of."""
SPAN = 0.2
"""Way of a joint over an episode, in [rad], that makes a delay visible."""


class Seen(NamedTuple):
    """What one player saw in an episode, and what it commanded.

    Attributes:
        observations: Puck (x, y, yaw and their rates), joints, their velocities, and if there is one the opponent's rod tip.
            Shape (T + 1, 6 + 2n [+ 3]).
        commands: Joint positions at the ends of the steps, in [rad]; None where they were not recorded. Shape (T, n).
    """

    observations: Array
    commands: Array | None = None


class Finding(NamedTuple):
    """One number of a profile.

    Attributes:
        value: In the profile's unit; None where the recording does not say it.
        spread: Its standard error.
        basis: What it comes from, or why there is none.
    """

    value: Any
    spread: float | None
    basis: str


def identify(episodes: Sequence[Seen], start: Sequence[float]) -> dict[str, Finding]:
    """What disturbed some episodes.

    Args:
        episodes: Of one robot.
        start: Joint positions at the beginning of an episode, in [rad]. Shape (n,).

    Returns:
        Key of a profile (such as "puck.position") -> what was found.

    Raises:
        ConfigurationError: There is too little to say anything, or it is not what this robot sees.
    """
    n = len(start)
    rows = [one.observations for one in episodes]
    steps = sum(map(len, rows))
    if steps < LEAST:
        raise ConfigurationError(f"{steps} observations say nothing of noise; it takes {LEAST} or more")
    wrong = {row.shape[1] for row in rows} - {6 + 2 * n, 9 + 2 * n}
    if wrong:
        raise ConfigurationError(
            f"observations of {min(wrong)} numbers; with {n} joints there are {6 + 2 * n}, or with an opponent {9 + 2 * n}"
        )
    if not all(np.isfinite(row).all() for row in rows):
        raise ConfigurationError("there are observations that are not finite")
    lost = [_lost(row) for row in rows]
    new = [~_late(row) for row in rows]
    found = {
        f"puck.{name}": _noise(rows, [fresh & ~gone for fresh, gone in zip(new, lost, strict=True)], columns, "puck", floor)
        for name, columns, floor in (
            ("position", slice(0, 2), "position"), ("yaw", slice(2, 3), "yaw"),
            ("velocity", slice(3, 5), "velocity"), ("yaw_rate", slice(5, 6), "yaw_rate"),
        )
    }  # fmt: skip
    still = [fresh & _slow(row[:, 6 : 6 + n]) for fresh, row in zip(new, rows, strict=True)]
    found["joints.position"] = _noise(rows, still, slice(6, 6 + n), "joints", "position")
    jitter = _noise(rows, still, slice(6 + n, 6 + 2 * n), "joints", "velocity")
    found["joints.velocity"] = jitter._replace(basis=f"{jitter.basis}; noise on the torque adds to it")
    found["joints.position_bias"] = _bias(rows, np.array(start), found["joints.position"])
    found["opponent.position"] = _noise(rows, new, slice(6 + 2 * n, 9 + 2 * n), "opponent", "position")
    found |= _track_loss(rows, lost)
    found["delay"] = _delay(episodes, n)
    return found


def profile_of(found: dict[str, Finding], name: str) -> Disturbances:
    """The profile that says so; what was not found is left out of it."""
    parts: dict[str, dict[str, Any]] = {}
    for key, finding in found.items():
        part, _, field = key.partition(".")
        if finding.value is not None:
            parts.setdefault(part, {})[field] = finding.value
    return Disturbances(
        profile=name,
        puck=PuckNoise(**parts.get("puck", {})),
        joints=JointNoise(**parts.get("joints", {})),
        opponent=OpponentNoise(**parts.get("opponent", {})),
        track_loss=TrackLoss(**parts.get("track_loss", {})),
        delay=parts.get("delay", {}).get("", 0),
    )


def _noise(rows: list[Array], good: list[NDArray[np.bool_]], columns: slice, part: str, kind: str) -> Finding:
    """Standard deviation of some entries' noise, where observations are good."""
    order = ORDERS[part]
    values = [
        _differences(row[:, columns], fine, order, wraps=kind == "yaw") for row, fine in zip(rows, good, strict=True)
    ]
    number = sum(one.size for one in values)
    if number < LEAST:
        return Finding(None, None, "there is no opponent" if part == "opponent" and not number else f"{number} values")

    def spread(some: Iterable[Array]) -> float:
        return float(np.median(np.abs(np.concatenate(list(some))))) / NORMAL / sqrt(comb(2 * order, order))

    value, error = _with_error(values, spread)
    if value < FLOORS[kind]:
        return Finding(0.0, None, f"{number} values; what there is, the motion explains")
    return Finding(value, error, f"{number} values")


def _differences(values: Array, good: NDArray[np.bool_], order: int, wraps: bool = False) -> Array:
    """All differences of an order between observations that are good. Shape (k,)."""
    if len(values) <= order or not values.shape[1]:
        return np.empty(0)
    values = np.unwrap(values, axis=0) if wraps else values
    whole = np.lib.stride_tricks.sliding_window_view(good, order + 1).all(axis=1)
    return np.diff(values, order, axis=0)[whole].ravel()


def _with_error(values: list[Array], estimate: Callable[[Iterable[Array]], float]) -> tuple[float, float]:
    """An estimate from all episodes, and its standard error from those of parts of them."""
    parts = [values[k::PARTS] for k in range(PARTS)]
    each = [estimate(part) for part in parts if sum(one.size for one in part) >= LEAST // PARTS]
    error = float(np.std(each, ddof=1)) / sqrt(len(each)) if len(each) > 1 else float("nan")
    return estimate(values), error


def _slow(joints: Array) -> NDArray[np.bool_]:
    """The slower half of the steps, in which an arm's acceleration disturbs least; by the way over many steps, not by noise."""
    reach = np.minimum(np.arange(len(joints)) + 4, len(joints) - 1)
    way = np.abs(joints[reach] - joints[np.maximum(np.arange(len(joints)) - 4, 0)]).max(axis=1)
    return np.asarray(way <= np.median(way))


def _lost(row: Array) -> NDArray[np.bool_]:
    """Where the puck's track was lost: what was seen before is seen again, or its place without any velocity."""
    lost = np.zeros(len(row), bool)
    same_place = (row[1:, :3] == row[:-1, :3]).all(axis=1)
    same_motion = (row[1:, 3:6] == row[:-1, 3:6]).all(axis=1) | (row[1:, 3:6] == 0.0).all(axis=1)
    lost[1:] = same_place & same_motion & ~_late(row)[1:]
    if lost[1:].mean() > 0.5 or not _noisy(row, lost):  # a puck that lies still without noise is not lost
        last = np.maximum.accumulate(np.where(lost, 0, np.arange(len(row))))
        lost &= np.hypot(row[last, 3], row[last, 4]) > MOVING
    return lost


def _late(row: Array) -> NDArray[np.bool_]:
    """Where the first observation is seen again, joints included: with a delay, nothing newer has come yet."""
    late = np.zeros(len(row), bool)
    late[1 : LONGEST_DELAY + 1] = np.cumprod((row[1 : LONGEST_DELAY + 1] == row[0]).all(axis=1))
    return late


def _noisy(row: Array, lost: NDArray[np.bool_]) -> bool:
    """Whether a puck at rest is seen in places that differ."""
    differences = _differences(row[:, :2], ~lost, 2)
    return bool(differences.size and np.median(np.abs(differences)) > FLOORS["position"])


def _track_loss(rows: list[Array], lost: list[NDArray[np.bool_]]) -> dict[str, Finding]:
    begins, lengths, chances, shows_zero = 0, list[int](), 0, 0
    for row, gone in zip(rows, lost, strict=True):
        edges = np.diff(np.concatenate([[0], gone.astype(int), [0]]))
        first, after = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
        begins += len(first)
        chances += int((~gone[:-1]).sum())
        whole = (after < len(row)) & (first > LONGEST_DELAY)  # not cut short by the episode's end, nor by its begin
        lengths.extend((after - first)[whole].tolist())
        shows_zero += int((row[first, 3:6] == 0.0).all(axis=1).sum())
    share = begins / max(chances, 1)
    basis = f"{begins} losses in {chances} steps"
    if not begins:
        return {"track_loss.probability": Finding(0.0, None, basis)}
    found = {"track_loss.probability": Finding(share, sqrt(share * (1.0 - share) / chances), basis)}
    if lengths:
        found["track_loss.length"] = Finding(_range(lengths, share), None, f"{len(lengths)} whole losses")
    shows = "zero_velocity" if shows_zero > begins / 2 else "hold"
    found["track_loss.shows"] = Finding(shows, None, f"{max(shows_zero, begins - shows_zero)} of {begins}")
    return found


def _range(lengths: list[int], share: float) -> tuple[int, int]:
    """Shortest and longest loss, all between being as likely, that make the lengths seen likeliest.

    What is seen as one may be several: another begins at once as often as after any step.
    """
    longest = max(lengths)
    seen = np.bincount(lengths)

    def likelihood(low: int, high: int) -> float:
        one = np.zeros(longest + 1)
        one[low : high + 1] = 1.0 / (high + 1 - low)
        several, together = one, np.zeros(longest + 1)
        for k in range(FOLLOWING):
            together += (1.0 - share) * share**k * several
            several = np.convolve(several, one)[: longest + 1]
        return float(seen @ np.log(np.maximum(together, 1e-300)))

    ranges = [(low, high) for low in range(1, min(lengths) + 1) for high in range(low, longest + 1)]
    return max(ranges, key=lambda ends: likelihood(*ends))


def _bias(rows: list[Array], start: Array, noise: Finding) -> Finding:
    """From the first observations of episodes, which all begin at the same joints."""
    first = np.array([row[0, 6 : 6 + len(start)] for row in rows]) - start
    if len(first) < PARTS or noise.value is None:
        return Finding(None, None, f"{len(first)} episodes")
    variance = float((first**2).mean())
    excess, error = variance - noise.value**2, variance * sqrt(2.0 / first.size)
    basis = f"first observations of {len(first)} episodes"
    if excess < 3.0 * error or sqrt(excess) < FLOORS["position"]:
        return Finding(0.0, None, f"{basis}; noise explains them")
    return Finding(sqrt(excess), error / (2.0 * sqrt(excess)), basis)


def _delay(episodes: Sequence[Seen], n: int) -> Finding:
    """By how many steps the joints that are seen follow those that were commanded."""
    total = np.zeros(LONGEST_DELAY + 1)
    number = 0
    for seen, commands in episodes:
        if commands is None or len(commands) < 2 * LONGEST_DELAY:
            continue
        moved = np.ptp(commands, axis=0) > SPAN
        joints = seen[1:, 6 : 6 + n][: len(commands), moved]
        number += int(moved.any())
        for delay in range(LONGEST_DELAY + 1):
            late = commands[LONGEST_DELAY - delay : len(joints) - delay, moved]
            total[delay] += float(((joints[LONGEST_DELAY:] - late) ** 2).sum())
    if not number:
        return _delay_at_start([one.observations for one in episodes])
    return Finding(int(total.argmin()), None, f"joints against commands in {number} episodes")


def _delay_at_start(rows: list[Array]) -> Finding:
    """By how often the first observation is seen again, where there is noise to tell observations apart."""
    again = [int(_late(row).sum()) for row in rows]
    if max(again) == LONGEST_DELAY:
        return Finding(None, None, "neither noise nor commands that move the arm were recorded")
    return Finding(int(np.median(again)), None, f"first observations of {len(rows)} episodes")
