"""Seeds: the environment's tree stands to the bit, and nothing about it follows from what an agent is given."""

import numpy as np

from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator import Options
from airhockey.evaluator.play.episode import EpisodePlayer
from airhockey.evaluator.play.seeding import AGENT, ENVIRONMENT, agent_seed_of, game_agents_seed, game_seed, seed_of
from airhockey.evaluator.runs.records import Job
from submissions import make_submission

SECRET = "0123456789abcdef0123456789abcdef"


def words(sequence: np.random.SeedSequence) -> list[int]:
    return sequence.generate_state(4).tolist()


def test_without_a_secret_seeds_are_what_they_were() -> None:
    assert words(agent_seed_of(None, 7, "3dof-hit", 2, AGENT)) == words(seed_of(7, "3dof-hit", 2, AGENT))
    assert words(game_agents_seed(None, 7, "0")) == words(np.random.SeedSequence(7).spawn(2)[1])
    assert game_seed(0, "0") < 1 << 32 and game_seed(0, "0") != game_seed(1, "0")


def test_with_a_secret_an_agents_seed_does_not_depend_on_the_environments() -> None:
    for index in range(3):
        assert words(agent_seed_of(SECRET, 7, "3dof-hit", index, AGENT)) == words(
            agent_seed_of(SECRET, 8, "3dof-hit", index, AGENT)
        )
    assert words(game_agents_seed(SECRET, 1, "0")) == words(game_agents_seed(SECRET, 2, "0"))
    assert words(game_agents_seed(SECRET, 1, "0")) != words(game_agents_seed(SECRET, 1, "1"))


def test_the_games_of_a_run_that_cannot_be_guessed_cannot_be_guessed() -> None:
    seeds = [game_seed(1 << 100 | 5, str(k)) for k in range(20)]
    assert len(set(seeds)) == 20 and max(seeds) > 1 << 120


def test_the_secret_changes_what_an_agent_draws_and_not_what_it_meets(tmp_path) -> None:  # type: ignore[no-untyped-def]
    agent = make_submission(tmp_path)
    first, drawn = [], []
    for secret in (None, SECRET, SECRET):
        options = Options(environments=("3dof-defend",), agent=agent, seed=3, agent_seed=secret)
        player = EpisodePlayer(options, load_disturbances("server"))
        trajectory = player(Job("3dof-defend", 0)).trajectory
        player.close()
        first.append(trajectory["observations"][0])
        drawn.append(trajectory["actions"][0])
    np.testing.assert_array_equal(first[0], first[1])
    np.testing.assert_array_equal(drawn[1], drawn[2])
    assert (drawn[0] != drawn[1]).any()
    assert words(seed_of(3, "3dof-defend", 0, ENVIRONMENT)) != words(agent_seed_of(SECRET, 3, "3dof-defend", 0, AGENT))
