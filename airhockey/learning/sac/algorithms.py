"""SAC with a replay buffer that knows the table's symmetry, and the Optimistic Actor Critic beside it (thesis 2.2.4)."""

from typing import Any

import numpy as np
import torch
from stable_baselines3 import SAC
from stable_baselines3.common.buffers import ReplayBuffer
from stable_baselines3.common.type_aliases import ReplayBufferSamples

Tensor = Any
"""A torch.Tensor; torch brings no types that mypy may look at here."""


class MirroredReplay(ReplayBuffer):
    """Shows each transition as it was, or, as often, in a mirror along the table's middle line."""

    def __init__(self, *args: Any, observation_mirror: Any, action_mirror: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._observation_mirror = torch.as_tensor(np.asarray(observation_mirror, dtype=np.float32))
        self._action_mirror = torch.as_tensor(np.asarray(action_mirror, dtype=np.float32))

    def sample(self, batch_size: int, env: Any = None) -> ReplayBufferSamples:
        """A batch in which half of the transitions, drawn afresh each time, are mirrored."""
        batch = super().sample(batch_size, env)
        chosen = torch.from_numpy(np.random.random((batch_size, 1)) < 0.5)
        observation = torch.where(chosen, self._observation_mirror, 1.0)
        return batch._replace(
            observations=batch.observations * observation,
            actions=batch.actions * torch.where(chosen, self._action_mirror, 1.0),
            next_observations=batch.next_observations * observation,
        )


class OAC(SAC):
    """Optimistic Actor Critic (Ciosek et al., NeurIPS 2019, equations 5 to 7, proposition 7).

    With two critics of mean μ_Q and standard deviation σ_Q = |Q₁ − Q₂| / 2, the update uses the lower bound μ_Q − σ_Q =
    min(Q₁, Q₂), as SAC does; exploration shifts the policy's mean towards where the upper bound μ_Q + β σ_Q grows:

        μ_E = μ_T + √(2δ) Σ_T g / ‖g‖_Σ,   g = ∂(μ_Q + β σ_Q)/∂a at a = μ_T

    before the tanh, with covariance Σ_T. δ = 0 is SAC.

    Args:
        optimism: δ, the largest Kullback–Leibler divergence of the exploration's policy from the target's.
        upper: β.
    """

    def __init__(self, *args: Any, optimism: float = 5.0, upper: float = 4.66, **kwargs: Any) -> None:
        self.optimism, self.upper = optimism, upper
        super().__init__(*args, **kwargs)

    def predict(
        self, observation: Any, state: Any = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Any, Any]:
        """SAC's action, from the shifted policy when it explores."""
        if deterministic or self.optimism == 0.0:
            return super().predict(observation, state, episode_start, deterministic)
        tensor, vectorized = self.policy.obs_to_tensor(observation)
        mean, log_std, _ = self.actor.get_action_dist_params(tensor)
        shift = self._shift(tensor, mean.detach(), log_std.detach())
        with torch.no_grad():
            action = torch.tanh(mean + shift + log_std.exp() * torch.randn_like(mean)).numpy()
        low, high = self.action_space.low, self.action_space.high  # type: ignore[attr-defined]
        action = low + 0.5 * (action + 1.0) * (high - low)
        return (action if vectorized else action[0]), state

    def _shift(self, observation: Tensor, mean: Tensor, log_std: Tensor) -> Tensor:
        """√(2δ) Σ g / √(gᵀ Σ g). Shape (b, m)."""
        raw = mean.clone().requires_grad_(True)
        values = torch.cat(self.critic(observation, torch.tanh(raw)), dim=1)
        upper = values.mean(dim=1) + self.upper * values.std(dim=1, unbiased=False)
        (gradient,) = torch.autograd.grad(upper.sum(), raw)
        covariance = (2.0 * log_std).exp()
        norm = torch.sqrt((gradient**2 * covariance).sum(dim=1, keepdim=True)) + 1e-6
        return float(np.sqrt(2.0 * self.optimism)) * covariance * gradient / norm
