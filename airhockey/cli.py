"""The `hockey` command: its sub-commands are found by name and imported when they are called."""

import importlib
import os
import sys
from collections.abc import Sequence
from typing import Any

import rich_click as click

from airhockey import __version__
from airhockey.commands import HELP_PAGE
from airhockey.commands._streams import be_patient, leave, silence
from airhockey.errors import AirHockeyError
from airhockey.inputs.names import shown

USAGE_ERROR = 2
_LONGEST = 4000  # characters of a message


class LazyGroup(click.RichGroup):
    """A group whose commands are the modules of `airhockey.commands`: a module's name is its command's, with _ for -."""

    names = (
        "evaluate",
        "match",
        "tournament",
        "watch",
        "replay",
        "video",
        "failures",
        "report",
        "leaderboard",
        "train",
        "plot",
        "agents",
        "new",
        "validate",
        "package",
        "serve-agent",
        "doctor",
    )

    def list_commands(self, ctx: Any) -> list[str]:
        """The commands' names, in the order of the help page."""
        return list(self.names)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Import a command; None where there is none of that name."""
        if cmd_name not in self.names:
            return None
        name = cmd_name.replace("-", "_")
        return getattr(importlib.import_module(f"airhockey.commands.{name}"), name)


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.rich_config(help_config=HELP_PAGE)
@click.version_option(__version__, prog_name="hockey")
def hockey() -> None:
    """Robot air hockey: agents on the challenge's tasks, judged by its rules.

    The tasks are 3dof-hit, 3dof-defend, 7dof-hit, 7dof-defend and 7dof-prepare. For example:

    \b
    hockey evaluate --task prepare            the default agent, 1000 episodes
    hockey evaluate --task all --agent hold   every task of the 7-DoF robot
    hockey agents                             who there is to play
    """


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; an error that the user can mend is one line and exit status 2."""
    os.environ["PYTHONSAFEPATH"] = "1"  # no child of ours imports from the present folder, which may be anybody's
    be_patient()
    try:
        status = hockey.main(arguments, prog_name="hockey", standalone_mode=False)
    except click.ClickException as error:
        command = getattr(getattr(error, "ctx", None), "command_path", "hockey")
        status = complain(f"{error.format_message()} (see {command} --help)")
    except AirHockeyError as error:
        status = complain(str(error))
    except click.Abort:
        status = 130
    except BrokenPipeError:
        silence()
        status = 1
    except OSError as error:
        status = complain(f"{error.filename or 'the standard output'}: {error.strerror or error}")
    lost = leave()
    if lost is not None:
        complain(f"the standard output could not be written ({lost}); what was played is stored")
        status = status or 1
    sys.exit(status)


def complain(message: str) -> int:
    """Say in one line what is wrong; returns the exit status of bad input."""
    click.echo(f"hockey: {shown(' '.join(message.split()), _LONGEST)}", err=True)
    return USAGE_ERROR


if __name__ == "__main__":
    main()
