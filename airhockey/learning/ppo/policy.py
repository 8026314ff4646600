"""Stable-Baselines3's PPO with a policy whose mean is what `Network` plays: rectified units, and tanh at the end."""

from typing import Any

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.policies import ActorCriticPolicy

from airhockey.agents.atacom.network import Network
from airhockey.learning.ppo.records import Settings

_DEFAULTS = {"net_arch": [128, 128], "activation_fn": torch.nn.ReLU, "log_std_init": -0.5}


class BoundedMeanPolicy(ActorCriticPolicy):
    """The mean of an action is within [−1, 1], as the action itself.

    Args:
        given: See `ActorCriticPolicy`; here two layers of 128 rectified units, and actions that deviate by 0.6 at first.
    """

    def __init__(self, *spaces: Any, **given: Any) -> None:
        super().__init__(*spaces, **(_DEFAULTS | given))

    def _build(self, lr_schedule: Any) -> None:
        super()._build(lr_schedule)
        self.action_net = torch.nn.Sequential(self.action_net, torch.nn.Tanh())
        self.optimizer = self.optimizer_class(self.parameters(), lr=lr_schedule(1), **self.optimizer_kwargs)


def make_model(settings: Settings, vec: Any) -> PPO:
    """PPO with a run's settings, silent."""
    s = settings
    model = PPO(
        BoundedMeanPolicy,
        vec,
        learning_rate=lambda remaining: s.learning_rate * (0.1 + 0.9 * remaining),
        n_steps=s.rollout,
        batch_size=s.batch,
        n_epochs=s.epochs,
        gamma=s.discount,
        gae_lambda=s.trace,
        policy_kwargs={"net_arch": [s.hidden, s.hidden]},
        seed=s.seed,
        device="cpu",
    )  # fmt: skip
    model.set_logger(Logger(None, []))
    return model


def network_of(model: PPO) -> Network:
    """The policy's mean, for play."""
    policy: Any = model.policy
    parts = [*policy.mlp_extractor.policy_net, *policy.action_net]
    weights = {}
    for k, layer in enumerate(layer for layer in parts if isinstance(layer, torch.nn.Linear)):
        weights[f"weight_{k}"] = layer.weight.detach().numpy().copy()
        weights[f"bias_{k}"] = layer.bias.detach().numpy().copy()
    return Network(weights)
