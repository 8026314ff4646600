"""`hockey watch`: a live task or game in the browser."""

from typing import Any

import rich_click as click

from airhockey.commands import _options as common


@click.command()
@click.argument("agent", metavar="A")
@click.argument("away", metavar="[B]", required=False)
@click.option(
    "--task",
    type=click.Choice(["hit", "defend", "prepare"]),
    default="hit",
    show_default=True,
    help="What A plays alone.",
)
@common.options(common.robot, common.env, common.edition, common.game_steps, common.seed)
@click.option(
    "--episode", type=click.IntRange(min=0), default=0, show_default=True, help="Episode or game to begin with."
)
@common.options(common.disturbances)
@common.options(*common.ISOLATION, *common.VIEWER)
@click.pass_context
def watch(ctx: click.RichContext, /, **given: Any) -> None:
    """Watch A at a task, or A play B, live in MuJoCo's viewer in the browser.

    Episodes are those of `hockey evaluate` and games those of `hockey match` with the same options. The panel shows score,
    faults, penalty and what the players are doing; the orange line is where the puck will go, discs are where the players
    want their mallets. Buttons and keys: space pauses, . steps, + and - change the speed, r restarts, n and p choose the
    episode; q in the terminal quits.

    \b
    hockey watch planner --task hit
    hockey watch planner thesis
    hockey watch planner --env hit_single --edition 2025
    hockey watch submissions/my_agent --env 7dof-prepare --disturbances server --episode 12
    hockey watch planner --no-browser --port 9000        then: ssh -L 9000:127.0.0.1:9000 …
    """
    common.typed_options(ctx, given)
    from airhockey.commands._session import agent_of, say_what_is_not_protected
    from airhockey.commands._viewer import show_in_viewer

    agents = [agent_of(given[name]) for name in ("agent", "away") if given[name] is not None]
    live = _game(agents, given) if given["away"] is not None else _task(agents[0], given)
    say_what_is_not_protected(agents, given["isolate"])
    show_in_viewer(live, given)


def _task(agent: str, given: dict[str, Any]) -> Any:
    from airhockey.commands._session import disturbances_of, edition_of
    from airhockey.envs.editions import edition
    from airhockey.evaluator import Options
    from airhockey.evaluator.checks import check_options
    from airhockey.evaluator.isolation.modes import choose
    from airhockey.viewing.live import LiveTask

    typed = () if given["env"] is None else (given["env"],)
    year = edition_of(given, (agent,), typed)
    options = Options(
        environments=(edition(year).counterpart(given["env"] or f"{given['robot']}-{given['task']}"),),
        edition=year,
        agent=agent,
        episodes=given["episode"] + 1,
        seed=given["seed"],
        disturbances=disturbances_of(given),
        isolate=choose(agent, given["isolate"]).mode,
        patience=given["patience"],
    )
    check_options(options)
    return LiveTask(options, given["episode"])


def _game(agents: list[str], given: dict[str, Any]) -> Any:
    from airhockey.commands._session import game_options_of
    from airhockey.errors import ConfigurationError
    from airhockey.evaluator.checks import check_agent, check_game_options
    from airhockey.viewing.live import LiveGame

    if given["env"] is not None:
        raise ConfigurationError("two players play a game: leave out --env, or the second player")
    options = game_options_of(given | {"real_time": 0.0}, dict.fromkeys(agents))
    check_game_options(options)
    for agent in agents:
        check_agent(agent, ("tournament",))
    return LiveGame(agents[0], agents[1], options, given["seed"], given["episode"])
