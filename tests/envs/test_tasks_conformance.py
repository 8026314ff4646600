"""What every task of every edition keeps to, page by page and environment by environment."""

import importlib
import re

import numpy as np
import pytest
from arms import standing, swinging

from airhockey import envs
from airhockey.envs import editions, tasks
from airhockey.envs.tasks import verdicts
from airhockey.envs.tasks.game import new_game
from airhockey.errors import ConfigurationError

PAGES = pytest.mark.parametrize("page", tasks.available())
EVERY = pytest.mark.parametrize(
    ("edition", "name"),
    [(edition, name) for edition in editions.available() for name in editions.edition(edition).environments],
)
PUCKS = np.random.default_rng(0).uniform(-1.0, 1.0, (4000, 6)) * [1.1, 0.6, np.pi, 2.0, 2.0, 60.0]


def manual(page):
    return importlib.import_module(f"airhockey.envs.tasks.{page}").__doc__


@PAGES
def test_a_page_is_a_manual(page):
    """Start, ends, reward, observation and action in tables of equal columns, success in words."""
    text = manual(page)
    heads = [
        line for line, rule in zip(text.splitlines(), text.splitlines()[1:], strict=False) if rule.startswith("|---")
    ]
    for what in ("start", "ends", "reward", "observation", "action"):
        assert any(re.search(rf"\b{what}\b", head.split("|")[1]) for head in heads), f"no table of the {what}"
    assert "Success:" in text
    for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        rows = [re.split(r"(?<!\\)\|", line) for line in table.splitlines()]
        assert len({len(row) for row in rows}) == 1 and len(rows) > 2, table


@PAGES
def test_a_page_is_played_somewhere_and_names_the_environments(page):
    played = {
        n for e in editions.available() for n, rules in editions.edition(e).environments.items() if rules.kind == page
    }
    assert played and all(f"`{name}`" in manual(page) for name in played)


@EVERY
def test_the_tables_count_the_observation(edition, name):
    env = envs.make(name, edition=edition)
    n = env.env_info["robot"]["n_joints"]
    kind = env.edition.environment(name).kind
    last = re.findall(r"^\| (?:\d+, \d+, \d+|[^|]* … ([\dn+]+)) \|", manual(kind), re.MULTILINE)
    ends = [eval(place.replace("2n", "2*n"), {"n": n}) for place in last if "n" in place]
    assert env.reset(seed=0).size // env.n_players - 1 in ends


@EVERY
@pytest.mark.parametrize("profile", ["ideal", "harsh"])
def test_shapes_types_and_determinism(edition, name, profile):
    told = []
    for env in (envs.make(name, disturbances=profile, edition=edition) for _ in range(2)):
        space = env.env_info["rl_info"].observation_space
        rows = [env.reset(seed=5)]
        for action in swinging(env, 12):
            observation, reward, absorbing, _ = env.step(action)
            assert type(reward) is float and type(absorbing) is bool and np.isfinite(reward)
            assert absorbing == (env.verdict != verdicts.GOING_ON)
            rows.append(observation)
        assert all(row.dtype == np.float64 and row.shape == (env.n_players * space.shape[0],) for row in rows)
        told.append(np.array(rows).tobytes())
    assert told[0] == told[1]
    env.reset(seed=6)
    assert env.base_observation.tobytes() != envs.make(name, edition=edition).base_observation.tobytes()


@EVERY
def test_starts_lie_on_the_table_and_within_the_editions_areas(edition, name):
    env = envs.make(name, edition=edition)
    areas = env.edition.starts_of(name)
    for seed in range(100):
        env.reset(seed=seed)
        x, y, _, vx, vy, rate = env.base_observation[:6]
        assert env.verdict == verdicts.GOING_ON and env.step_count == 0
        x = -abs(x) if env.n_players == 2 else x  # either side serves
        area = next(
            area
            for area in areas
            if area.x[0] <= x <= area.x[1] and any(area.y[0] <= s * y <= area.y[1] for s in (1, -1))
        )
        fastest = area.speed[1] if area.speed else 0.0
        assert np.hypot(vx, vy) <= fastest + 1e-12
        assert abs(rate) <= (area.yaw_rate[1] if area.yaw_rate else 0.0)


@EVERY
def test_a_referee_says_one_thing_and_success_is_a_tasks(edition, name):
    """On thousands of pucks: a verdict is one of the list, off the table is never going on, and a game has no success."""
    env = envs.make(name, edition=edition)
    rules = env._referee[0]
    codes = set()
    for puck in PUCKS:
        for kept, new in zip(env.game, new_game(), strict=True):
            kept[:] = new
        verdict = env.task.judge(env._referee, puck)
        code, success = verdict & ~verdicts.SUCCESS, verdict >= verdicts.SUCCESS
        assert verdicts.GOING_ON <= code <= verdicts.STUCK
        assert not (success and env.n_players == 2)
        if verdicts.off_table(rules, puck):
            assert code != verdicts.GOING_ON
        codes.add(code)
    games = {verdicts.GOAL_HOME, verdicts.GOAL_AWAY, verdicts.STUCK}
    assert codes >= {verdicts.GOING_ON, verdicts.OFF_TABLE} | (games if env.n_players == 2 else {verdicts.TASK_OVER})
    assert env.n_players == 2 or not codes & games


@EVERY
def test_a_tasks_reward_is_finite_and_the_sum_of_its_terms(edition, name):
    env = envs.make(name, edition=edition)
    kind = env.edition.environment(name).kind
    if env.task.reward is None:
        with pytest.raises(ConfigurationError, match="reward"):
            tasks.reward_for(kind)
        return
    reward = tasks.reward_for(kind)
    env.reset(seed=3)
    for _ in range(env.horizon):
        before = env.base_observation
        absorbing = env.step(standing(env))[2]
        value = reward(env, before, None, env.base_observation, absorbing)
        assert np.isfinite(value) and value == sum(reward.terms.values())
        if absorbing:
            break
    assert reward.terms.keys() & {"goal", "hit", "inside", "outside", "approach", "success", "failure"}


def test_an_edition_may_name_only_pages_that_there_are():
    with pytest.raises(ConfigurationError, match=r"unknown task 'hti'.*defend, game, hit, prepare.*'hit'"):
        tasks.task("hti")
