"""Saves the agent, as a training does at its end."""

from airhockey import compat, envs

compat.install()
import torch  # noqa: E402
from air_hockey_agent.agents.saved import Saved  # noqa: E402

torch.manual_seed(3)
Saved(envs.make("7dof-defend").env_info).save("air_hockey_agent/agents/saved.msh")
