"""A trained policy as the package keeps it: a network's file, and a card that says where it comes from."""

import datetime
from pathlib import Path
from typing import Any

import torch
import yaml
from stable_baselines3 import SAC

from airhockey import envs
from airhockey.agents.atacom.network import Network


def network_of(model: SAC) -> Network:
    """The policy's mean as a NumPy network."""
    actor = model.actor
    linear = [layer for layer in actor.latent_pi if isinstance(layer, torch.nn.Linear)] + [actor.mu]
    layers = {}
    for k, layer in enumerate(linear):
        layers[f"weight_{k}"] = layer.weight.detach().numpy().copy()
        layers[f"bias_{k}"] = layer.bias.detach().numpy().copy()
    return Network(layers)


def write_card(path: Path, options: dict[str, Any], figures: dict[str, Any]) -> None:
    """Write what made a network beside it.

    Args:
        path: Of the card.
        options: Of the run.
        figures: What it reached.
    """
    import stable_baselines3

    versions = {**envs.versions(), "torch": torch.__version__, "stable_baselines3": stable_baselines3.__version__}
    card = {
        "made": datetime.date.today().isoformat(),
        "data": "simulated episodes of the task in this package, one seed each; nothing else",
        "options": options,
        "figures": figures,
        "versions": versions,
    }
    path.write_text(yaml.safe_dump(card, sort_keys=False, allow_unicode=True), encoding="utf-8")
