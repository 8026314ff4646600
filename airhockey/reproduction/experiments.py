"""Which runs each table and figure needs, and how large they are."""

from dataclasses import dataclass

import msgspec

from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.errors import unknown
from airhockey.evaluator.match import MatchOptions
from airhockey.evaluator.runs.game_records import GameOptions
from airhockey.evaluator.runs.records import Options
from airhockey.learning.pgpe.records import Settings
from airhockey.learning.pgpe.stage import FIXED_STARTS
from airhockey.learning.pgpe.trainable import names_of, ranges, read
from airhockey.reproduction.printed import FIGURES, GAMES, QUALIFYING, WARM_UP

PARTS = ("table-5.1", "table-5.2", "table-5.3", *GAMES, *FIGURES)
"""Tables and figures of chapter 5."""
PRINTED = "thesis.parameters=thesis"
"""The setting that plays the thesis's text and nothing else."""
_STRAIGHT, _NO_MACHINE = "thesis.home.curved=false", "thesis.state_machine=false"
PLAYERS: dict[str, tuple[str, tuple[str, ...]]] = {
    "table-5.4": ("thesis", (PRINTED, _STRAIGHT, _NO_MACHINE)),
    "table-5.5": ("thesis", (PRINTED, _STRAIGHT)),
    "table-5.6": ("thesis", (PRINTED,)),
    "table-5.7": ("thesis-final", (PRINTED,)),
}
"""Table of a whole game -> its player, and what is set about it."""
OPPONENT = "ordinary"
SERVER = "server"
"""Profile of all runs but the trainings: the thesis's tables are of the organisers' server, or of local tests with its noise."""


class ReproductionOptions(msgspec.Struct, frozen=True, kw_only=True):
    """What is run.

    Attributes:
        seed: Of every run; a training's further seeds count on from it.
        episodes: Of each task in tables 5.1 to 5.3.
        games, steps: Of tables 5.4 to 5.7: how many, and how long in control steps.
        iterations, candidates, rollouts: Of every training: updates, θ tried in each, and episodes played with each.
        seeds: How often the training of figures 5.4 and 5.5 is repeated.
        disturbances: Of tables.
    """

    seed: int = 0
    episodes: int = 1000
    games: int = 10
    steps: int = 45000
    iterations: int = 200
    candidates: int = 10
    rollouts: int = 5
    seeds: int = 5
    disturbances: str = SERVER


def quick(seed: int) -> ReproductionOptions:
    """Everything once, as small as it can be: shows that it runs, and no more."""
    return ReproductionOptions(
        seed=seed, episodes=5, games=1, steps=1000, iterations=4, candidates=2, rollouts=2, seeds=1
    )


@dataclass(frozen=True)
class Experiment:
    """A run.

    Attributes:
        key: Its folder's name.
        parts: Tables ("table-5.1") and figures that show it.
        options: Of an evaluation, a match or a training.
    """

    key: str
    parts: tuple[str, ...]
    options: Options | MatchOptions | Settings

    @property
    def size(self) -> int:
        """How many episodes it has; 500 control steps of a game count as one."""
        if isinstance(self.options, Options):
            return len(self.options.environments) * self.options.episodes
        if isinstance(self.options, MatchOptions):
            return self.options.games * max(self.options.game.steps // 500, 1)
        return self.options.iterations * self.options.candidates * self.options.episodes


def experiments(options: ReproductionOptions, parts: tuple[str, ...] = ()) -> list[Experiment]:
    """The runs of some tables and figures, or of all; raises `ConfigurationError` for one that there is not."""
    for part in parts:
        if part not in PARTS:
            raise unknown("table or figure of chapter 5", part, PARTS)
    everything = [*_tasks(options), *_games(options), *_trainings(options)]
    return [one for one in everything if not parts or set(parts) & set(one.parts)]


def _tasks(o: ReproductionOptions) -> list[Experiment]:
    """Tables 5.1 to 5.3: the thesis's text, and the player with this project's additions and parameters."""
    found = []
    for parts, table, agent in (
        (("table-5.1",), WARM_UP, "thesis"),
        (("table-5.2", "table-5.3"), QUALIFYING, "thesis-final"),
    ):
        for name, settings in (("printed", (PRINTED,)), ("tuned", ())):
            options = Options(
                environments=tuple(table.success), agent=agent, settings=settings, episodes=o.episodes, seed=o.seed,
                disturbances=o.disturbances, isolate="none",
            )  # fmt: skip
            found.append(Experiment(f"{parts[0]}-{name}", parts, options))
    return found


def _games(o: ReproductionOptions) -> list[Experiment]:
    game = GameOptions(steps=o.steps, disturbances=o.disturbances, isolate="none")
    return [
        Experiment(
            part,
            (part,),
            MatchOptions(
                home=agent,
                away=OPPONENT,
                games=o.games,
                seed=o.seed,
                swap_sides=True,
                game=game,
                settings=(settings, ()),
            ),
        )
        for part, (agent, settings) in PLAYERS.items()
    ]


def _trainings(o: ReproductionOptions) -> list[Experiment]:
    """Natural gradients, because with the plain ones the printed learning rate throws θ from bound to bound."""
    names = tuple(names_of("hit"))

    def training(
        key: str,
        parts: tuple[str, ...],
        seed: int,
        trained: tuple[str, ...],
        reward: str = "thesis",
        fixed: str = "none",
    ) -> Experiment:
        settings = Settings(
            task="hit", robot="7dof", seed=seed, names=trained,
            mean=tuple(map(float, read(thesis_parameters("thesis"), trained))),
            sigma=tuple(ranges()[name].sigma for name in trained),
            candidates=o.candidates, episodes=o.rollouts, iterations=o.iterations,
            learning_rate=1e-4, sigma_rule="thesis", baseline="moving", normalize=False, reward=reward, fixed_start=fixed,
        )  # fmt: skip
        return Experiment(key, parts, settings)

    found = [training("figure-5.1", ("figure-5.1",), o.seed, names, "sparse")]
    for k, name in enumerate(names):
        parts = ("figure-5.2", "figure-5.3") if k == 0 else ("figure-5.2",)
        found.append(training(f"figure-5.2-theta{k}", parts, o.seed, (name,), "sparse"))
    for fixed in FIXED_STARTS[1:]:
        found.append(training(f"figure-5.3-{fixed}", ("figure-5.3",), o.seed, names[:1], "sparse", fixed))
    for seed in range(o.seed, o.seed + o.seeds):
        found.append(training(f"figure-5.4-s{seed}", ("figure-5.4", "figure-5.5"), seed, names))
    return found
