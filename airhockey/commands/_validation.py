"""What `hockey validate` does once its options are read."""

import os
from collections.abc import Mapping
from typing import Any

import click
import msgspec

from airhockey.commands._isolation import isolation_of, say_what_is_not_protected
from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.workers import ONE_THREAD

PROBLEMS = 3


def run(given: Mapping[str, Any]) -> int:
    """Validate and print the verdict; gives the exit status."""
    os.environ.update(ONE_THREAD)
    from airhockey.evaluator.isolation.limits import Limits
    from airhockey.evaluator.validation import validate

    path = given["path"]
    if not path.exists():
        raise ConfigurationError(f"there is no {str(path)!r}; name a submission's folder or archive")
    mode = isolation_of(str(path.resolve()), given["isolate"])
    say_what_is_not_protected((str(path.resolve()),), given["isolate"])
    patience = given["patience"]
    limits = Limits(patience=patience, start=max(patience, Limits.start))
    verdict = validate(path, mode, limits, given["steps"])
    if given["as_json"]:
        click.echo(msgspec.json.encode(verdict))
        return PROBLEMS if verdict.problems else 0
    for trial in verdict.trials:
        click.echo(
            f"{trial.env:12} {trial.steps} steps; draw_action {trial.median * 1e3:.2f} ms (median), "
            f"{trial.longest * 1e3:.2f} ms (longest), {trial.first * 1e3:.2f} ms (first); loaded in {trial.start:.1f} s"
        )
    for name, why in verdict.left_out.items():
        click.echo(f"left out by hockey package: {name} ({why})")
    for problem in verdict.problems:
        click.echo(f"problem in {problem.where}: {problem.what}\n  remedy: {problem.remedy}")
    count = len(verdict.problems)
    click.echo(f"{verdict.name}: fit to be handed in" if not count else f"{verdict.name}: {count} problem(s)")
    return PROBLEMS if count else 0
