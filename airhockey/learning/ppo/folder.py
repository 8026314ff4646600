"""A run's folder: that of a skill's training, and in it a player that can be named wherever an agent is.

train.json, log.csv, checkpoint.pkl, card.yaml   see `airhockey.learning.sac.folder`
air_hockey_agent/                                a submission: agent_builder.py, network.npz, policy.yaml, submission.yaml

The submission needs NumPy and this package, and no torch.
"""

from typing import Any

import yaml

from airhockey.agents.atacom.network import Network
from airhockey.agents.learned.player import NETWORK, POLICY
from airhockey.agents.packaging.metadata import METADATA
from airhockey.envs.editions import DEFAULT, edition
from airhockey.evaluator.runs.disk import replace_file
from airhockey.learning.ppo.records import Settings
from airhockey.learning.sac.folder import SkillFolder

PACKAGE, BUILDER = "air_hockey_agent", "agent_builder.py"
_BUILDER = '''"""A network's player, written by hockey train ppo."""

import pathlib

from airhockey.agents.learned.player import LearnedPlayer


def build_agent(env_info, **kwargs):
    """The player beside this file."""
    return LearnedPlayer.load(pathlib.Path(__file__).parent, env_info, **kwargs)
'''


class PolicyFolder(SkillFolder):
    """The folder of a policy's training, opened for writing."""

    options_type = Settings

    def save_network(self, network: Network) -> None:
        """The submission, each of its files whole or not at all; the builder last, which makes it one."""
        options: Any = self.manifest.options
        horizon = edition(DEFAULT).horizon.task
        policy = {"actions": options.actions, "repeat": options.repeat, "horizon": horizon, "task": options.task}
        metadata = {
            "name": f"ppo-{options.task}-{options.actions}", "version": "0.1.0", "authors": [], "packages": [],
            "interpolation_order": 3, "tasks": [options.task],
        }  # fmt: skip
        package = self.path / PACKAGE
        package.mkdir(exist_ok=True)
        replace_file(package / NETWORK, network.as_bytes())
        replace_file(package / POLICY, yaml.safe_dump(policy, sort_keys=False).encode())
        replace_file(package / METADATA, yaml.safe_dump(metadata, sort_keys=False).encode())
        replace_file(package / BUILDER, _BUILDER.encode())
