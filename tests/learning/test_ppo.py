"""PPO: the same run for the same seed, through a kill and with other threads; and its player plays what was trained."""

import csv

import msgspec
import numpy as np
import pytest
import torch

from airhockey import envs
from airhockey.agents.atacom.network import Network
from airhockey.agents.build import build_agent
from airhockey.agents.learned.player import LearnedPlayer
from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.learning.diverged import DivergedError
from airhockey.learning.envs.batch import LearningBatch
from airhockey.learning.ppo.folder import PolicyFolder
from airhockey.learning.ppo.records import Settings
from airhockey.learning.ppo.trainer import Trainer, evaluate_policy

SHORT = Settings(
    task="3dof-defend", steps=4 * 3 * 40, envs=3, rollout=40, epochs=2, batch=40, hidden=16, save_every=2, seed=3,
    disturbances="server",
)  # fmt: skip


def trained(path, settings=SHORT, threads=1, resume=False):
    folder = PolicyFolder.resume(path) if resume else PolicyFolder.begin(settings, path)
    with folder:
        trainer = Trainer(folder, threads)
        trainer.run()
    return trainer


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    path = tmp_path_factory.mktemp("runs") / "finished"
    return path, trained(path)


def parameters_of(trainer):
    return torch.cat([values.flatten() for values in trainer.model.policy.state_dict().values()]).numpy().tobytes()


def rows(path):
    """The log without its speeds, which are nobody's promise."""
    return [row[:-1] for row in csv.reader((path / "log.csv").open())]


def test_another_number_of_threads_gives_the_same_network(finished, tmp_path):
    path, trainer = finished
    assert trainer.model.num_timesteps == SHORT.steps and len(rows(path)) == 5
    again = trained(tmp_path / "again", threads=2)
    assert parameters_of(again) == parameters_of(trainer) and rows(tmp_path / "again") == rows(path)


def test_a_run_that_was_killed_goes_on_as_if_nothing_had_happened(finished, tmp_path):
    path, trainer = finished
    killed = tmp_path / "killed"
    with PolicyFolder.begin(SHORT, killed) as folder:
        begun = Trainer(folder)
        with pytest.raises(KeyboardInterrupt):
            begun.run(lambda line: (_ for _ in ()).throw(KeyboardInterrupt) if line.iteration == 3 else None)
    assert len(rows(killed)) == 4  # a line more than the checkpoint
    assert parameters_of(trained(killed, resume=True)) == parameters_of(trainer)
    assert rows(killed) == rows(path)


def test_a_run_that_diverges_keeps_its_last_good_checkpoint(tmp_path):
    path = tmp_path / "run"
    with PolicyFolder.begin(SHORT, path) as folder:
        trainer = Trainer(folder)

        def spoil(line):
            if line.iteration == 2:
                with torch.no_grad():
                    trainer.model.policy.log_std[0] = np.nan

        with pytest.raises((DivergedError, ValueError)):
            trainer.run(spoil)
    Network.load(path / "air_hockey_agent" / "network.npz")


def test_the_runs_folder_is_an_agent_that_plays_what_was_trained(finished):
    path, trainer = finished
    seed = np.random.SeedSequence(5)
    env = envs.make("3dof-defend", disturbances="server")
    observation = env.reset(seed)
    agent = build_agent(path, env.env_info)
    agent.episode_start()
    batch = LearningBatch("3dof-defend", 1, disturbances="server")
    told = batch.reset([seed])
    network = trainer.network
    for step in range(60):
        if step % 2 == 0:
            told = batch.step(network(told.observations[0])[None])
        command = agent.draw_action(observation)
        if step % 2 == 1:  # the batch's command is that of its last control step
            assert command.tobytes() == batch.fleet.actions[0, 0, :2].tobytes()
        observation, _, over, _ = env.step(command)
        if over or told.terminated[0]:
            assert step > 10
            break


def test_unseen_episodes_are_the_same_however_many_are_played_at_a_time(finished):
    _, trainer = finished
    profile = load_disturbances("server")
    figures = [evaluate_policy(SHORT, profile, trainer.network, 5, envs=count) for count in (1, 2, 5)]
    assert [one | {"violations": 0} for one in figures] == [figures[0] | {"violations": 0}] * 3
    assert figures[0]["violations"] == 0.0


def test_a_network_of_another_robot_is_refused(finished):
    path, _ = finished
    joints = Network({"weight_0": np.zeros((7, 49), np.float32), "bias_0": np.zeros(7, np.float32)})
    info = envs.make("3dof-defend").env_info
    with pytest.raises(ConfigurationError, match=r"maps 49 numbers to 7.*has 35 and 2"):
        LearnedPlayer(info, joints)
    (path / "air_hockey_agent" / "policy.yaml").rename(path / "kept")
    with pytest.raises(ConfigurationError, match=r"cannot read .*policy\.yaml"):
        build_agent(path, info)
    (path / "kept").rename(path / "air_hockey_agent" / "policy.yaml")


def test_settings_are_records():
    assert msgspec.json.decode(msgspec.json.encode(SHORT), type=Settings) == SHORT
