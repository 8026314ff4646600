"""`hockey reproduce`: the experiments of a publication, run again and compared with what it prints."""

from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.argument("what", metavar="thesis", type=click.Choice(["thesis"]))
@click.option(
    "--table", "tables", metavar="5.1 … 5.7", multiple=True, help="Only what this table needs; may be repeated."
)
@click.option(
    "--figure", "figures", metavar="5.1 … 5.5", multiple=True, help="Only what this figure needs; may be repeated."
)
@click.option("--quick", is_flag=True, help="Everything as small as it can be: shows that it runs, in minutes.")
@common.options(common.seed, common.jobs, *common.RUN)
@click.pass_context
def reproduce(ctx: click.RichContext, /, **given: Any) -> None:
    """Run chapter 5 of the thesis again: all its tables and figures, on one page beside what is printed.

    The whole takes hours; it can be interrupted, or killed, at any moment and goes on with --resume, also with other tables and
    figures than before. The page, thesis.html in the run's folder, needs nothing but itself; every run in the folder can be
    shown by `hockey report`, `hockey plot` and `hockey replay`.

    For example:

    \b
    hockey reproduce thesis --quick
    hockey reproduce thesis --table 5.4 --table 5.5
    hockey reproduce thesis --resume --out runs/thesis-s0
    """
    from airhockey.commands import _progress
    from airhockey.commands._session import Session, cpus
    from airhockey.evaluator.engines.engine import engine_for
    from airhockey.reproduction.experiments import ReproductionOptions, experiments, quick
    from airhockey.reproduction.folder import PAGE, ReproductionFolder
    from airhockey.reproduction.page import write_page

    parts = (*(f"table-{one}" for one in given["tables"]), *(f"figure-{one}" for one in given["figures"]))
    session = Session("reproduce thesis", given, common.typed_options(ctx, given))
    options = quick(given["seed"]) if given["quick"] else ReproductionOptions(seed=given["seed"])
    experiments(options, parts)  # a table that there is not is refused before a folder is made
    name = f"thesis{'-quick' if given['quick'] else ''}-s{options.seed}"
    folder = session.open(options, name, ReproductionFolder.begin, ReproductionFolder.resume)
    planned = experiments(folder.manifest.options, parts)
    total, engine = sum(one.size for one in planned), engine_for(given["jobs"] or cpus())

    def play(tell: _progress.Tell) -> None:
        done = 0

        def more(count: int) -> None:
            nonlocal done
            done += count
            tell(completed=done)

        with folder:
            for number, one in enumerate(planned, start=1):
                if one.key in folder.done:
                    more(one.size)
                    continue
                tell(f"{number}/{len(planned)} {one.key}: {one.size:,} episodes")
                if folder.records:
                    write_page(folder)
                folder.play(one, engine, more)
            write_page(folder)  # also where a kill came between the last run and its page

    def show(_: None) -> int:
        click.echo(folder.path / PAGE)
        return 0

    progress = _progress.of_training(_progress.STARTING, "episodes", total, 0, session.quiet)
    ctx.exit(session.run(folder, f"{len(planned)} experiments", progress, play, show))
