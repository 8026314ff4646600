"""`hockey train`: a group whose commands are imported when they are called."""

import importlib
from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE

_COMMANDS = {"pgpe": "train_pgpe", "ppo": "train_ppo", "sac": "train_sac"}
"""A command's name and the module of this package that holds it, as a function of the command's name."""


class _TrainingMethods(click.RichGroup):
    """The group's commands, found by name."""

    def list_commands(self, ctx: Any) -> list[str]:
        """The commands' names, in the order of the help page."""
        return list(_COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Import a command; None where there is none of that name."""
        if cmd_name not in _COMMANDS:
            return None
        return getattr(importlib.import_module(f"airhockey.commands.{_COMMANDS[cmd_name]}"), cmd_name)


@click.group(cls=_TrainingMethods)
@click.rich_config(help_config=HELP_PAGE)
def train() -> None:
    """Train a player: the numbers of the rule-based one by PGPE or CMA-ES, skills by SAC and
    whole tasks by PPO under constraints.

    For example:

    \b
    hockey train pgpe --task hit --robot 3dof    parameters of the rule-based hit
    hockey train sac --task defend               a network for the defence
    hockey train ppo --task 7dof-defend          a network for a whole task
    """
