"""Seeds: every owner of randomness in an episode has its own, so that an episode can be played again alone."""

import random
import sys
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

ENVIRONMENT, AGENT, AGENT_BUILD = range(3)


def seed_of(run_seed: int, env_name: str, index: int, owner: int) -> np.random.SeedSequence:
    """The seed of one owner in one episode, whatever else is played.

    Args:
        run_seed: The run's seed, ≥ 0.
        env_name: Name of the environment. Its checksum, not its place in a list, enters the seed.
        index: Index of the episode in its task.
        owner: `ENVIRONMENT`, `AGENT` or `AGENT_BUILD` (index 0: an agent is built once and plays many episodes).
    """
    return np.random.SeedSequence(run_seed, spawn_key=(zlib.crc32(env_name.encode()), index, owner))


def agent_seed_of(secret: str | None, run_seed: int, env_name: str, index: int, owner: int) -> np.random.SeedSequence:
    """The seed of an agent in one episode; with a secret nothing about the environment's seeds follows from it.

    Args:
        secret: Of the run, in hexadecimal; None for seeds that follow from the run's.
        run_seed, env_name, index, owner: As for `seed_of`.
    """
    return seed_of(run_seed if secret is None else int(secret, 16), env_name, index, owner)


def game_seed(run_seed: int, key: str) -> int:
    """The seed of one game, from the run's seed and the game's key in it. A number, so that it can be typed and shown.

    One of a run whose seed is too long to be guessed is too long to be guessed as well.
    """
    sequence = np.random.SeedSequence(run_seed, spawn_key=(zlib.crc32(key.encode()),))
    if run_seed >= 1 << 64:
        return int.from_bytes(sequence.generate_state(4).tobytes(), "little")
    return int(sequence.generate_state(1)[0])


def game_agents_seed(secret: str | None, seed: int, key: str) -> np.random.SeedSequence:
    """The seed of both players of a game, from the run's secret; from the game's seed where there is none.

    Args:
        secret: As for `agent_seed_of`.
        seed, key: The game's.
    """
    if secret is None:
        return np.random.SeedSequence(seed).spawn(2)[1]
    return np.random.SeedSequence(int(secret, 16), spawn_key=(zlib.crc32(key.encode()), 1))


def seed_global_generators(seed: np.random.SeedSequence) -> None:
    """Seed the generators that an agent in this process may draw from without asking."""
    seed_generators(seed.generate_state(4))


def seed_generators(words: NDArray[Any]) -> None:
    """Seed Python's generator, NumPy's and, where loaded, torch's. Shape (4,)."""
    np.random.seed(words)
    number = int(words[0])
    random.seed(number)
    torch = sys.modules.get("torch")
    if torch is not None:
        torch.manual_seed(number)
