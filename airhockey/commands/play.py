"""`hockey play`: a person against an agent, in the browser."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import _options as common

if TYPE_CHECKING:
    from airhockey.evaluator.match import MatchOptions

PERSON = "person"


@click.command()
@click.argument("opponent", metavar="[AGENT]", default="ordinary")
@click.option(
    "--minutes",
    type=click.FloatRange(min=0.01, max=60.0),
    default=3.0,
    show_default=True,
    help="How long, at full speed.",
)
@click.option(
    "--speed",
    type=click.FloatRange(min=0.1, max=2.0),
    default=1.0,
    show_default=True,
    help="Of time: 0.5 is slow motion.",
)
@common.options(common.edition, common.seed, common.disturbances, *common.ISOLATION)
@common.options(common.host, common.port, common.no_browser, common.out)
@click.pass_context
def play(ctx: click.RichContext, /, **given: Any) -> None:
    """Play AGENT yourself: your mallet follows mouse or finger, within the arm's limits.

    The page shows the table from above; your half has the blue mallet. Real rules apply: fifteen seconds a side, three faults are
    a point. The game is recorded like any other, for `hockey replay`, `hockey video` and `hockey report`.

    \b
    hockey play
    hockey play planner --minutes 5
    hockey play submissions/my_agent --speed 0.5
    hockey play --no-browser --port 9000        then: ssh -L 9000:127.0.0.1:9000 …
    """
    common.typed_options(ctx, given)
    import webbrowser

    from airhockey.agents.person import HAND
    from airhockey.commands import _tables
    from airhockey.commands._session import (
        AGENT_FAILED,
        INTERRUPTED,
        NOBODYS_FAULT,
        agent_of,
        new_folder,
        say_what_is_not_protected,
    )
    from airhockey.commands._viewer import has_display
    from airhockey.errors import EnvironmentFault, SimulationError
    from airhockey.evaluator.match import begin_match, play_match
    from airhockey.inputs.names import one_line
    from airhockey.viewing.play_page import PlayPage, Shown

    options = _options(given, agent_of(given["opponent"]))
    name = f"play-{Path(options.away).name}-s{options.seed}"
    with PlayPage(HAND, given["host"], given["port"]) as page:
        folder = begin_match(options, Path(given["out"]) if given["out"] is not None else new_folder(name))
        say_what_is_not_protected([options.away], given["isolate"])
        click.echo(f"play at {page.address}", err=True)
        if not given["no_browser"] and has_display():
            webbrowser.open(page.address)
        try:
            with folder.released_on_error():
                page.wait_for_person()
            result = play_match(folder, Shown(page.show))
        except KeyboardInterrupt:
            click.echo("hockey: stopped; a game that is not played to its end is not kept", err=True)
            ctx.exit(INTERRUPTED)
        except (EnvironmentFault, SimulationError) as error:
            click.echo(f"hockey: {one_line(str(error))}", err=True)
            ctx.exit(NOBODYS_FAULT)
        page.end("The game is over.")
    _tables.print_match(result, folder)
    ctx.exit(AGENT_FAILED if any(any(game.failures) for game in result.games) else 0)


def _options(given: dict[str, Any], opponent: str) -> "MatchOptions":
    """One game against the opponent, at the pace of the robots."""
    from airhockey.commands._session import game_options_of
    from airhockey.envs.specs import CONTROL_PERIOD
    from airhockey.errors import ConfigurationError
    from airhockey.evaluator.match import MatchOptions

    if opponent == PERSON:
        raise ConfigurationError("one person plays at a page: name another opponent, as in hockey play ordinary")
    steps = max(1, round(60.0 * given["minutes"] / CONTROL_PERIOD))
    game = game_options_of({**given, "steps": steps, "real_time": given["speed"]}, {opponent: None})
    return MatchOptions(home=PERSON, away=opponent, seed=given["seed"], game=game)
