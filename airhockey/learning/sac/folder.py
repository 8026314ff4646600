"""A run's folder, written so that it can be killed at any moment.

train.json       the manifest
log.csv          a line every so many episodes
checkpoint.pkl   everything needed to go on, replay buffer and random states included
network.npz      the policy, as a player reads it
card.yaml        where it comes from and, at the end, what it reaches

The checkpoint is this program's own pickle: like any other, it must not be taken from strangers.
"""

import csv
import os
import pickle
from typing import Any, ClassVar

import msgspec
import yaml

from airhockey import envs
from airhockey.agents.atacom.network import Network
from airhockey.evaluator.runs.disk import disk_errors, replace_file
from airhockey.evaluator.runs.folder import RunFolder
from airhockey.evaluator.runs.manifest import TRAINING, TrainingManifest
from airhockey.inputs.broken import check_size, reading_errors
from airhockey.learning.sac.plots import LOG
from airhockey.learning.sac.records import Settings

LARGEST_CHECKPOINT = 16 << 30
"""In bytes."""
CHECKPOINT, NETWORK, CARD = "checkpoint.pkl", "network.npz", "card.yaml"


class SkillFolder(RunFolder[Any, Any]):
    """The folder of a skill's training, opened for writing; its journal is the log."""

    name = TRAINING
    options_type: ClassVar[type] = Settings
    manifest_type = TrainingManifest

    @classmethod
    def versions(cls) -> dict[str, str]:
        """Of all that decides a result."""
        import stable_baselines3
        import torch

        return {
            **envs.versions(), "torch": str(torch.__version__), "stable_baselines3": str(stable_baselines3.__version__)
        }  # fmt: skip

    def recover(self) -> list[Any]:
        """Nothing yet: `load` mends the log by the checkpoint."""
        return []

    def add(self, line: msgspec.Struct) -> None:
        """A line of the log."""
        with disk_errors(self.path), (self.path / LOG).open("a", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            if file.tell() == 0:
                writer.writerow(line.__struct_fields__)
            values = msgspec.structs.astuple(line)
            writer.writerow([f"{value:.6g}" if isinstance(value, float) else value for value in values])

    def save(self, state: dict[str, Any], network: Network) -> None:
        """A checkpoint and the policy at it, each whole or not at all."""
        with disk_errors(self.path):
            log = self.path / LOG
            state = {**state, "log": log.stat().st_size if log.exists() else 0}
            replace_file(self.path / CHECKPOINT, pickle.dumps(state, protocol=5))
            self.save_network(network)

    def save_network(self, network: Network) -> None:
        """The policy, as a player reads it."""
        replace_file(self.path / NETWORK, network.as_bytes())

    def load(self) -> dict[str, Any] | None:
        """The last checkpoint, or None before the first; what the log says of later episodes is cut off."""
        log, path = self.path / LOG, self.path / CHECKPOINT
        state: dict[str, Any] | None = None
        if path.exists():
            with reading_errors(path):
                check_size(path, LARGEST_CHECKPOINT)
                state = pickle.loads(path.read_bytes())
        if log.exists():
            os.truncate(log, min(log.stat().st_size, 0 if state is None else state["log"]))
        return state

    def write_card(self, figures: dict[str, Any]) -> None:
        """Where the policy comes from, and what it reaches."""
        card = {
            "data": "episodes simulated by this package, each with a seed of its own; nothing else",
            "settings": msgspec.structs.asdict(self.manifest.options),
            "figures": figures,
            "versions": self.manifest.versions,
            "made": self.manifest.created,
        }
        text = yaml.safe_dump(card, sort_keys=False, allow_unicode=True)
        with disk_errors(self.path):
            replace_file(self.path / CARD, text.encode())
