"""Write the pages of the rules, one an edition, with drawings, from the editions' own files.

python scripts/rules_pages.py docs/rules
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

from airhockey.envs import editions
from airhockey.envs.editions import Edition, Start
from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK, TABLE

PIXELS = 300  # a metre
MARGIN = 0.06  # [m]
INK, START, GOAL, SUCCESS = "#7a8291", "#2f6fd6", "#d92e20", "#2c9c5a"
CONSTRAINTS = {
    "joint_pos_constr": "a joint beyond 95 % of its range",
    "joint_vel_constr": "a joint faster than 95 % of its limit",
    "ee_constr": "the mallet outside the table's borders, or more than 0.02 m off the height of its plane",
    "link_constr": "the elbow or wrist of the iiwa lower than 0.25 m",
    "computation_time": "`draw_action` too slow, see below",
}
OFF = "the puck is off the table, goals included, or ‖(ẋ, ẏ, yaw rate)‖ > {fast:g}"
ENDS = {
    "hit": OFF + "; or it comes back: x > 0 and ẋ < 0",
    "defend": OFF + "; or it is back where it came from: x > 0 and ẋ > 0; or it lies still: ‖(ẋ, ẏ)‖ < {still:g}",
    "prepare": OFF + "; or it is on the other half, or on the middle line: \\|y\\| < {line:g}",
    "game": "a goal, a fault or a puck that is stuck: the next serve follows at once",
}
SUCCESSES = {
    "hit": "at the last step the puck is in the opponent's goal",
    "defend": "at the last step {near:g} < x ≤ {far:g} and ẋ < {slow:g}",
    "prepare": "at the last step {near:g} < x ≤ {far:g}, \\|y\\| < {band:.5g} and ẋ < {slow:g}",
    "game": "more points than the opponent",
}


def main() -> None:
    """Write them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    folder: Path = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages().items():
        (folder / name).write_text(text, encoding="utf-8")


def pages() -> dict[str, str]:
    """Every file of the folder by its name."""
    made = {}
    for year in editions.available():
        rules = editions.edition(year)
        made[f"{year}.md"] = "\n".join(page(rules)) + "\n"
        for name in rules.environments:
            made[f"{year}-{name}.svg"] = drawing(rules, name)
    return made


def page(rules: Edition) -> Iterator[str]:
    """The lines of an edition's page."""
    yield f"# Rules of {rules.edition}\n"
    yield (
        f"Written from `airhockey/envs/assets/editions/{rules.edition}.yaml`, which simulator and judge read. Lengths are in "
        "[m], speeds in [m/s], angles in [rad]; the origin is the table's centre, x points to the opponent's goal. The\n"
        "docstrings of `airhockey.envs.tasks` list every entry of an observation and of an action.\n"
    )
    yield (
        f"The table is {TABLE.length:g} × {TABLE.width:g}, a goal {TABLE.goal_width:g} wide; the puck's radius is "
        f"{PUCK.radius:g}, a mallet's {MALLET.radius:g}. A control step takes {CONTROL_PERIOD:g} s;\n"
        f"an episode lasts up to {rules.horizon.task} steps, a game {rules.horizon.game}.\n"
    )
    yield "## Environments\n"
    for name in rules.environments:
        yield from environment(rules, name)
    yield "## Penalties\n"
    yield "An episode costs, at most once for each kind:\n"
    yield "| constraint | violated by | points |\n|---|---|---|"
    for name, points in rules.penalty_points.items():
        yield f"| `{name}` | {CONSTRAINTS[name]} | {points:g} |"
    yield "\nFor the time of `draw_action` in an episode, the first row that applies:\n"
    yield "| longest above | or mean above | points |\n|---|---|---|"
    for time in rules.computation_time:
        mean = "–" if time.mean_above == float("inf") else f"{1e3 * time.mean_above:g} ms"
        yield f"| {1e3 * time.max_above:g} ms | {mean} | {time.points:g} |"
    limits = rules.deployability
    yield (
        f"\nA run of 1000 episodes is *Deployable* up to {limits.deployable:g} points, *Improvable* up to "
        f"{limits.improvable:g}, and *Non-deployable* beyond.\nA player whose mean over the {rules.horizon.task}-step "
        f"episodes of a game is above {rules.game_penalty_per_episode:g} cannot win it.\n"
    )
    yield "## Games\n"
    game = rules.game
    yield (
        f"A puck that stays on one side for {game.fault_time:g} s is a fault of that side; {game.faults_per_point} faults "
        "are a point for the opponent. A puck that lies\n"
        f"still in the middle (\\|x\\| < {game.middle_zone:g}, \\|ẋ\\| < {game.stuck_speed:g}) is served again; that is nobody's "
        "fault.\n"
    )
    yield "## Score of a run\n"
    yield "| robot | tasks and their weights |\n|---|---|"
    for robot, weights in rules.score_weights.items():
        yield f"| {robot} | {', '.join(f'`{name}` {weight:g}' for name, weight in weights.items())} |"


def environment(rules: Edition, name: str) -> Iterator[str]:
    """One environment: drawing, starts, ends, success."""
    own = rules.environment(name)
    numbers = {
        "fast": rules.over.max_speed, "still": rules.over.standstill, "line": rules.over.middle_line,
        "near": rules.success.near_x, "far": rules.success.far_x, "slow": rules.success.slow,
        "band": rules.success.band_half_width,
    }  # fmt: skip
    yield f"### `{name}`\n"
    yield f"![Starts and success of {name}]({rules.edition}-{name}.svg)\n"
    arms = "two arms" if own.robots == 2 else "one arm"
    yield f"{'The iiwa with 7 joints' if own.robot == 'iiwa' else 'The planar arm with 3 joints'}, {arms}.\n"
    for start in rules.starts_of(name):
        yield f"- start: {start_of(start)}"
    yield f"- end: {ENDS[own.kind].format(**numbers)}"
    yield f"- success: {SUCCESSES[own.kind].format(**numbers)}\n"


def start_of(start: Start) -> str:
    """A region in words."""
    side = "\\|y\\|" if start.y[0] > 0.0 else "y"
    where = f"x {start.x[0]:g} … {start.x[1]:g}, {side} {start.y[0]:.5g} … {start.y[1]:.5g}"
    if start.speed is None:
        return f"{where}, at rest"
    assert start.angle is not None
    how = f"{start.speed[0]:g} … {start.speed[1]:g} m/s within {start.angle[0]:.3g} … {start.angle[1]:.3g} rad of our side"
    return f"{where}, with {how}"


def drawing(rules: Edition, name: str) -> str:
    """The table from above: where the puck starts (blue), goals (red), where it has to be in the end (green)."""
    half_length, half_width = TABLE.length / 2, TABLE.width / 2
    width, height = (2 * (half + MARGIN) * PIXELS for half in (half_length, half_width))
    kind = rules.environment(name).kind
    shapes = [
        rectangle(
            (-half_length, half_length), (-half_width, half_width), f'fill="none" stroke="{INK}" stroke-width="4"'
        ),
        line((0.0, -half_width), (0.0, half_width), INK, 2),
    ]
    success = rules.success
    if kind in ("defend", "prepare"):
        band = success.band_half_width if kind == "prepare" else half_width
        shapes.append(rectangle((success.near_x, success.far_x), (-band, band), f'fill="{SUCCESS}" fill-opacity="0.2"'))
    for start in rules.starts_of(name):
        sides = [start.y] if start.y[0] <= 0.0 else [start.y, (-start.y[1], -start.y[0])]
        shapes += [rectangle(start.x, y, f'fill="{START}" fill-opacity="0.35"') for y in sides]
    goal = TABLE.goal_width / 2
    for x in (-half_length, half_length):
        wanted = kind in ("hit", "game") and x > 0.0
        shapes.append(line((x, -goal), (x, goal), SUCCESS if wanted else GOAL, 8))
    body = "\n".join(shapes)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" role="img">\n'
        f"<title>{name} ({rules.edition}): starts in blue, goals in red, success in green</title>\n{body}\n</svg>\n"
    )


def rectangle(x: tuple[float, float], y: tuple[float, float], style: str) -> str:
    """A region of the table, in [m]."""
    left, top = _place(x[0], y[1])
    wide, high = ((place[1] - place[0]) * PIXELS for place in (x, y))
    return f'<rect x="{left:.1f}" y="{top:.1f}" width="{wide:.1f}" height="{high:.1f}" {style}/>'


def line(start: tuple[float, float], end: tuple[float, float], color: str, width: int) -> str:
    """From point to point, in [m]."""
    (x1, y1), (x2, y2) = _place(*start), _place(*end)
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{color}" stroke-width="{width}"/>'


def _place(x: float, y: float) -> tuple[float, float]:
    return (x + TABLE.length / 2 + MARGIN) * PIXELS, (TABLE.width / 2 + MARGIN - y) * PIXELS


if __name__ == "__main__":
    main()
