"""The group of the sub-commands, which are found by name and imported when they are called, and how every command ends."""

import importlib
import os
import sys
from collections.abc import Sequence
from typing import Any

import rich_click as click

from airhockey import __version__
from airhockey.commands import HELP_PAGE
from airhockey.commands._streams import be_patient, leave, silence
from airhockey.commands._threads import end_with
from airhockey.errors import AirHockeyError, EnvironmentFault, SimulationError
from airhockey.inputs.names import one_line

USAGE_ERROR, NOBODYS_FAULT = 2, 4
_BROKEN = "the installation is broken, which is no agent's fault"


class LazyGroup(click.RichGroup):
    """A group whose commands are the modules of `airhockey.commands`: a module's name is its command's, with _ for -."""

    names = (
        "evaluate",
        "match",
        "tournament",
        "watch",
        "play",
        "replay",
        "video",
        "failures",
        "identify",
        "export",
        "check-trajectory",
        "report",
        "leaderboard",
        "train",
        "plot",
        "reproduce",
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

    Exit statuses: 0, done; 2, bad input; 3, an agent failed; 4, the environment, its disturbances, a training or this
    machine failed, and no agent: nothing counts against anybody, and the run can go on; 130, interrupted.
    """


def run(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; an error that the user can mend is one line and exit status 2."""
    os.environ["PYTHONSAFEPATH"] = "1"  # no child of ours imports from the present folder, which may be anybody's
    be_patient()
    try:
        status = hockey.main(arguments, prog_name="hockey", standalone_mode=False)
    except click.ClickException as error:
        command = getattr(getattr(error, "ctx", None), "command_path", "hockey")
        status = complain(f"{error.format_message()} (see {command} --help)")
    except (EnvironmentFault, SimulationError) as error:
        status = complain(str(error), NOBODYS_FAULT)
    except AirHockeyError as error:
        status = complain(str(error))
    except ImportError as error:
        status = complain(f"{_BROKEN}: {error}", NOBODYS_FAULT)
    except MemoryError:
        status = complain("this machine has no memory left, which is no agent's fault", NOBODYS_FAULT)
    except click.Abort:
        status = 130
    except BrokenPipeError:
        silence()
        status = 1
    except OSError as error:
        if error.errno is None:  # the operating system names its errors; a library that cannot be loaded does not
            status = complain(f"{_BROKEN}: {error}", NOBODYS_FAULT)
        else:
            status = complain(f"{error.filename or 'cannot write'}: {error.strerror}")
    lost = leave()
    if lost is not None:
        complain(f"the standard output could not be written ({lost}); what was played is stored")
        status = status or 1
    end_with(status)
    sys.exit(status)


def complain(message: str, status: int = USAGE_ERROR) -> int:
    """Say in one line what is wrong; returns the exit status, that of bad input where none is given."""
    click.echo(f"hockey: {one_line(message)}", err=True)
    return status
