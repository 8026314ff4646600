"""Environments in threads of one process do not disturb each other, and resets do not pile anything up."""

import gc
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from arms import episode_bits, standing

from airhockey import envs

STATM = Path("/proc/self/statm")
PAIRS = [("7dof-hit", "tournament"), ("3dof-defend", "7dof-prepare"), ("7dof-hit", "7dof-hit")]


def play(job):
    name, seed = job
    env = envs.make(name, disturbances="harsh")
    told = b""
    for episode in range(3):
        told += env.reset(seed=seed + episode).tobytes() + episode_bits(env, 60)
    return told


@pytest.mark.parametrize("names", PAIRS, ids="-".join)
def test_two_threads_give_the_bits_of_one_after_the_other(names):
    jobs = list(zip(names, (1, 50), strict=True))
    alone = [play(job) for job in jobs]
    with ThreadPoolExecutor(2) as threads:
        together = list(threads.map(play, jobs))
    assert together == alone


def resident():
    """Memory of this process in [MB]."""
    gc.collect()
    return int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


@pytest.mark.skipif(not STATM.exists(), reason="Linux tells the memory of a process")
@pytest.mark.parametrize("name", ["3dof-hit", "tournament"])
def test_resets_and_steps_do_not_pile_up(name):
    env = envs.make(name, disturbances="harsh")

    def resets(count):
        for seed in range(count):
            env.reset(seed=seed)
            for _ in range(3):
                env.step(standing(env))

    resets(50)
    before = resident()
    resets(200)
    assert resident() - before < 5.0


@pytest.mark.skipif(not STATM.exists(), reason="Linux tells the memory of a process")
def test_environments_that_are_dropped_are_freed():
    def make(count):
        for _ in range(count):
            env = envs.make("tournament")
            env.step(standing(env))

    make(10)
    before = resident()
    make(40)
    assert resident() - before < 15.0
