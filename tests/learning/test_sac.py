"""Training skills: the same run for the same seed, through a kill and --resume; OAC beside SAC; constraints on the way."""

import copy
import csv
import pickle
import warnings

import msgspec
import numpy as np
import pytest
import torch
from gymnasium.utils.env_checker import check_env

from airhockey.agents.atacom.network import Network
from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.learning.diverged import DivergedError
from airhockey.learning.sac.algorithms import OAC, MirroredReplay
from airhockey.learning.sac.folder import SkillFolder
from airhockey.learning.sac.records import Line, Settings
from airhockey.learning.sac.skill_tasks import DefendEnv, HomeEnv
from airhockey.learning.sac.trainer import Trainer, make_env, make_model

IDEAL = load_disturbances("ideal")
SHORT = Settings(
    task="home", robot="3dof", steps=320, warm_up=150, hidden=16, batch=32, log_every=2, save_every=2, seed=3
)


def parameters_of(trainer):
    return torch.cat([values.flatten() for values in trainer.model.policy.state_dict().values()])


def trained(path, settings):
    folder = SkillFolder.begin(settings, path)
    try:
        trainer = Trainer(folder)
        trainer.run()
    finally:
        folder.close()
    return trainer


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    path = tmp_path_factory.mktemp("runs") / "finished"
    return path, trained(path, SHORT)


def rows(path):
    """The log without its speeds, which are nobody's promise."""
    return [row[:-1] for row in csv.reader((path / "log.csv").open())]


@pytest.mark.parametrize("kind", [DefendEnv, HomeEnv])
def test_gymnasiums_checker_accepts_the_skills_environment(kind):
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*wrapper applied.*")
        check_env(kind("3dof"), skip_render_check=True)


@pytest.mark.parametrize(("kind", "robot"), [(DefendEnv, "3dof"), (DefendEnv, "7dof"), (HomeEnv, "7dof")])
def test_random_actions_hardly_ever_violate(kind, robot):
    env, random = kind(robot), np.random.default_rng(0)
    for episode in range(8):
        env.reset(options={"seed": np.random.SeedSequence(episode)})
        over = False
        while not over:
            _, _, terminated, truncated, _ = env.step(random.uniform(-1.0, 1.0, 2))
            over = terminated or truncated
    assert env.steps > 500
    assert env.violations / env.steps < 0.01


def test_a_defence_is_rewarded_as_the_thesis_says_and_shaped():
    env = DefendEnv("3dof")
    env.reset(options={"seed": np.random.SeedSequence(4)})
    total, over = 0.0, False
    while not over:
        before = env._now
        _, reward, over, _, info = env.step(np.zeros(2))
        total += reward - env.shaping(before, env._now)
    speed = min(np.hypot(*env._now.puck.state[2:4]), 2.0)
    assert total == pytest.approx((10.0 if info["success"] else -1.0) - 2.0 * speed, abs=1e-6)


def test_the_way_home_begins_anywhere_and_ends_there():
    env, starts = HomeEnv("3dof"), []
    for seed in range(6):
        observation, _ = env.reset(options={"seed": np.random.SeedSequence(seed)})
        starts.append(env._now.tip)
        over = False
        while not over:
            observation, _, terminated, truncated, info = env.step(np.clip(observation[2:4], -1.0, 1.0))
            over = terminated or truncated
        assert info["success"] == terminated
    assert np.ptp(np.array(starts), axis=0).min() > 0.1


def test_the_same_seed_gives_the_same_run(finished, tmp_path):
    path, trainer = finished
    again = trained(tmp_path / "again", SHORT)
    assert torch.equal(parameters_of(trainer), parameters_of(again))
    assert rows(path) == rows(tmp_path / "again")
    other = trained(tmp_path / "other", msgspec.structs.replace(SHORT, seed=4))
    assert not torch.equal(parameters_of(trainer), parameters_of(other))


def test_a_run_that_was_stopped_goes_on_as_if_it_had_not_been(finished, tmp_path):
    path, trainer = finished
    stopped, lines = SkillFolder.begin(SHORT, tmp_path / "stopped"), []

    def stop(line):
        lines.append(line)
        if len(lines) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Trainer(stopped).run(stop)
    stopped.close()
    resumed = SkillFolder.resume(tmp_path / "stopped")
    torch.manual_seed(99)
    np.random.seed(99)
    goes_on = Trainer(resumed)
    assert 0 < goes_on.progress.steps < SHORT.steps
    goes_on.run()
    resumed.close()
    assert torch.equal(parameters_of(trainer), parameters_of(goes_on))
    assert rows(path) == rows(tmp_path / "stopped")


def test_the_log_says_what_was_counted(finished):
    path, trainer = finished
    header, *lines = csv.reader((path / "log.csv").open())
    assert tuple(header) == Line.__struct_fields__
    assert int(lines[-1][1]) == trainer.progress.steps >= SHORT.steps
    assert int(lines[-1][2]) == trainer.env.steps
    assert all(float(line[header.index("violations")]) < 0.01 for line in lines)


def test_the_networks_file_is_the_actors_mean(finished):
    path, trainer = finished
    network, random = Network.load(path / "network.npz"), np.random.default_rng(0)
    for _ in range(5):
        seen = random.normal(size=network.inputs).astype(np.float32)
        expected, _ = trainer.model.predict(seen, deterministic=True)
        np.testing.assert_allclose(network(seen), expected, atol=1e-5)


def test_oac_without_optimism_is_sac(finished, tmp_path):
    _, trainer = finished
    neutral = trained(tmp_path / "oac", msgspec.structs.replace(SHORT, algorithm="oac", optimism=0.0))
    assert isinstance(neutral.model, OAC)
    assert torch.equal(parameters_of(trainer), parameters_of(neutral))


def test_oac_explores_where_the_upper_bound_grows():
    """μ_E − μ_T against finite differences of the upper bound; its Kullback–Leibler divergence is δ."""
    settings = msgspec.structs.replace(SHORT, algorithm="oac", optimism=0.7)
    model = make_model(settings, make_env(settings, IDEAL))
    seen = torch.linspace(-2.0, 2.0, 12)[None]
    mean, log_std, _ = model.actor.get_action_dist_params(seen)
    mean, log_std = mean.detach(), log_std.detach()
    shift = model._shift(seen, mean, log_std)

    def upper(raw):
        first, second = model.critic(seen, torch.tanh(raw))
        return float(((first + second) / 2 + model.upper * (first - second).abs() / 2).detach())

    gradient = torch.tensor([[(upper(mean + e) - upper(mean - e)) / 4e-3 for e in 2e-3 * torch.eye(2)]])
    variance = (2.0 * log_std).exp()
    expected = np.sqrt(2 * 0.7) * variance * gradient / torch.sqrt((variance * gradient**2).sum())
    torch.testing.assert_close(shift, expected, rtol=2e-2, atol=2e-3)
    assert float((shift**2 / variance).sum() / 2) == pytest.approx(0.7, rel=1e-3)


def test_oac_learns_differently_from_sac(finished, tmp_path):
    optimistic = trained(tmp_path / "oac", msgspec.structs.replace(SHORT, algorithm="oac", optimism=0.7))
    assert not torch.equal(parameters_of(finished[1]), parameters_of(optimistic))


def test_half_of_a_batch_is_seen_in_the_mirror():
    env = make_env(SHORT, IDEAL)
    mirror = np.where(np.arange(12) % 2 == 0, 1.0, -1.0)
    buffer = MirroredReplay(
        4, env.observation_space, env.action_space, observation_mirror=mirror, action_mirror=[1.0, -1.0]
    )
    seen, action = np.arange(1.0, 13.0), np.array([0.5, 0.25])
    buffer.add(seen[None], 2.0 * seen[None], action[None], np.array([1.5]), np.array([False]), [{}])
    np.random.seed(0)
    batch = buffer.sample(400)
    mirrored = (batch.actions[:, 1] < 0).numpy()
    assert 150 < mirrored.sum() < 250
    for chosen, signs in ((mirrored, mirror), (~mirrored, np.ones(12))):
        np.testing.assert_array_equal(batch.observations[chosen], np.tile(signs * seen, (chosen.sum(), 1)))
        np.testing.assert_array_equal(batch.next_observations[chosen], np.tile(2 * signs * seen, (chosen.sum(), 1)))
    assert (batch.rewards == 1.5).all()


def test_a_return_that_is_not_finite_stops_the_run_and_keeps_the_checkpoint(tmp_path):
    folder = SkillFolder.begin(SHORT, tmp_path / "run")
    trainer = Trainer(folder)
    trainer.save()
    good = (tmp_path / "run" / "checkpoint.pkl").read_bytes()
    trainer.env.shaping = lambda before, after: float("nan")
    with pytest.raises(DivergedError, match="episode 1 is nan"):
        trainer.run()
    folder.close()
    assert (tmp_path / "run" / "checkpoint.pkl").read_bytes() == good


def test_parameters_that_are_not_finite_stop_the_run(tmp_path):
    folder = SkillFolder.begin(SHORT, tmp_path / "run")
    trainer = Trainer(folder)
    trainer.progress.owed = 1.0
    trainer.model.train = lambda *_: trainer.model.actor.mu.bias.data.fill_(float("inf"))
    with pytest.raises(DivergedError, match="not finite"):
        trainer._learn()
    folder.close()


def test_a_run_goes_on_with_the_disturbances_that_it_began_with(tmp_path):
    profile = tmp_path / "mine.yaml"
    profile.write_text("profile: mine\npuck: {position: 0.01}\n")
    settings = msgspec.structs.replace(SHORT, disturbances=str(profile))
    SkillFolder.begin(settings, tmp_path / "run").close()
    began_with = load_disturbances(str(profile))
    profile.write_text("profile: mine\npuck: {position: 0.5}\n")
    with SkillFolder.resume(tmp_path / "run") as folder:
        assert folder.manifest.profile == began_with
        assert Trainer(folder).env.unwrapped.environment.disturbances == began_with


def test_other_software_cannot_go_on_with_a_run(finished):
    path, _ = finished
    manifest = (path / "train.json").read_text()
    try:
        (path / "train.json").write_text(manifest.replace('"mujoco": "', '"mujoco": "0.'))
        with pytest.raises(ConfigurationError, match="began with mujoco 0"):
            SkillFolder.resume(path)
    finally:
        (path / "train.json").write_text(manifest)


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copied_environment_of_a_skill_is_one_of_its_own(way):
    env = DefendEnv("3dof", "server")
    env.reset(seed=2)
    env.step(np.array([0.3, -0.2]))
    twin = way(env)

    def played(one):
        steps = [one.step(np.array([0.5, 0.1 * k])) for k in range(4)]
        return [(seen.tobytes(), reward) for seen, reward, *_ in steps]

    expected = played(twin)
    assert played(env) == expected
