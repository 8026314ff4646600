"""`airhockey.envs.perception` for a batch: the same draws and the same sums, in compiled code.

The environments' own `Perception`s begin every episode; what they remember is copied here then, and back when asked for.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.environment import Environment
from airhockey.envs.perception import PerceptionState
from airhockey.envs.specs import SUBSTEPS, YAW
from airhockey.envs.vector.compiling import compiled
from airhockey.envs.vector.randomness import address_of, integer, standard_normal, uniform

Array = NDArray[np.float64]
Counts = NDArray[np.int64]
_PUCK = 6


class Profile(NamedTuple):
    """A profile of disturbances as compiled code wants it; see `airhockey.envs.disturbances`.

    Attributes:
        torque: Standard deviation of the motors' torques, in [N·m]. Shape (n,).
        deviation: Of an observation's entries. Shape (D,).
        probability: That a loss of the puck's track begins in a step.
        shortest, longest: Of a loss, in [steps].
        keeps_velocity: Whether the puck's last velocity is shown during a loss.
    """

    torque: Array
    deviation: Array
    probability: float
    shortest: int
    longest: int
    keeps_velocity: bool


class Senses(NamedTuple):
    """What the players of N environments perceive with; P players, D numbers in an observation.

    Attributes:
        blurred, shaken: Whether observations, and torques, are disturbed.
        plant: Addresses of the generators of torques. Shape (N,).
        randoms: Addresses of the players' generators. Shape (N, P).
        bias: The episodes'. Shape (N, P, D).
        seen: What was seen in the latest steps, in a ring. Shape (N, P, delay + 1, D).
        times: How many observations there were. Shape (N, P).
        lost_for: For how many more steps the puck is lost. Shape (N, P).
        scratch: Shape (N, 1).
    """

    blurred: bool
    shaken: bool
    plant: Counts
    randoms: Counts
    bias: Array
    seen: Array
    times: Counts
    lost_for: Counts
    scratch: NDArray[np.uint64]


def new_senses(single: Environment, n: int) -> tuple[Profile, Senses]:
    """Of n environments like this one."""
    profile, players = single.disturbances, single.n_players
    loss, deviation = profile.track_loss, single.perceptions[0].deviation[: single.true_observation.size // players]
    size = (n, players, deviation.size)
    return Profile(
        single.torque_deviation,
        deviation,
        loss.probability,
        *loss.length,
        loss.shows != "zero_velocity",
    ), Senses(
        profile.blurs_observations,
        profile.torque > 0.0,
        np.zeros(n, np.int64),
        np.zeros((n, players), np.int64),
        np.zeros(size),
        np.zeros((n, players, profile.delay + 1, deviation.size)),
        np.zeros((n, players), np.int64),
        np.zeros((n, players), np.int64),
        np.zeros((n, 1), np.uint64),
    )


def take_over(senses: Senses, i: int, env: Environment) -> None:
    """Perceive in place of an environment's own perceptions, from now on."""
    senses.plant[i] = address_of(env.plant_random)
    for p, perception in enumerate(env.perceptions):
        senses.randoms[i, p] = address_of(perception.random)
        if senses.blurred:
            _, bias, seen, senses.lost_for[i, p] = perception.save()
            senses.bias[i, p] = bias[: senses.bias.shape[2]]
            senses.times[i, p] = len(seen)
            senses.seen[i, p, : len(seen)] = seen


def give_back(senses: Senses, i: int, env: Environment) -> None:
    """Bring an environment's own perceptions up to date."""
    for p, perception in enumerate(env.perceptions if senses.blurred else ()):
        random, bias, _, _ = perception.save()
        length, count = senses.seen.shape[2], int(senses.times[i, p])
        seen = tuple(senses.seen[i, p, k % length].copy() for k in range(max(0, count - length), count))
        perception.restore(PerceptionState(random, bias, seen, int(senses.lost_for[i, p])))


@compiled
def shake(profile: Profile, senses: Senses, i: int, noise: Array) -> None:
    """Draw the torques that are added to the motors of environment i in a step. Shape (20, R, n)."""
    standard_normal(senses.plant[i], noise)
    for k in range(SUBSTEPS):
        for r in range(noise.shape[1]):
            for j in range(noise.shape[2]):
                noise[k, r, j] = noise[k, r, j] * profile.torque[j]


@compiled
def observe(profile: Profile, senses: Senses, i: int, p: int, true: Array, observation: Array) -> None:
    """Write what player p of environment i sees; see `Perception.observe`. Shapes (D,), (D,)."""
    ring, length = senses.seen[i, p], senses.seen.shape[2]
    count, random = senses.times[i, p], senses.randoms[i, p]
    standard_normal(random, observation)
    for k in range(true.shape[0]):
        observation[k] = true[k] + senses.bias[i, p, k] + profile.deviation[k] * observation[k]
    if abs(observation[YAW]) > math.pi:
        observation[YAW] = (observation[YAW] + math.pi) % (2.0 * math.pi) - math.pi
    if senses.lost_for[i, p] == 0 and uniform(random) < profile.probability:
        senses.lost_for[i, p] = integer(random, profile.shortest, profile.longest, senses.scratch[i])
    if senses.lost_for[i, p] > 0:
        senses.lost_for[i, p] -= 1
        if count > 0:
            last = ring[(count - 1) % length]
            for k in range(_PUCK):
                observation[k] = last[k] if k < _PUCK // 2 or profile.keeps_velocity else 0.0
    newest, oldest = ring[count % length], ring[max(0, count + 1 - length) % length]
    for k in range(true.shape[0]):
        newest[k] = observation[k]
    for k in range(true.shape[0]):
        observation[k] = oldest[k]
    senses.times[i, p] = count + 1
