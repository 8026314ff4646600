"""Recordings of this package (scripts/record.py), made when it reproduced those of the official one: replayed, they agree.

A replay may differ by 1e-9, or by a multiple of `chaos`, which is how far a changed last bit of the actions leads.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from airhockey import envs
from airhockey.envs.editions import available

FOLDER = Path(__file__).parent.parent / "data" / "recordings"
PATHS = sorted(FOLDER.glob("*.npz"))
THROUGH_THE_WRAPPER = (
    "3dof-defend_sweep_onone_s1",
    "7dof-defend_rims_o3_s1",
    "7dof-hit_strike_o3_s1",
    "7dof-prepare_sweep_o-1_s1",
    "tournament_serves_o3_s1",
    "2025-hit_strike_o3_s1",
    "2025-tournament_strike_o3_s1",
)
Array = NDArray[np.float64]


def replay(env: Any, recorded: dict[str, Array]) -> None:
    """Play the recorded actions and compare all that is told after each of them."""
    serves = dict(zip(recorded["reset_steps"].tolist(), recorded["reset_base_obs"], strict=True))
    bound = np.maximum(1e-9, 20.0 * recorded["chaos"])
    judged = recorded["chaos"] < 1e-4
    np.testing.assert_allclose(env.reset(state=recorded["init_base_obs"]), recorded["obs0"], rtol=0.0, atol=1e-9)
    for step, action in enumerate(recorded["actions"]):
        if step in serves:
            env.reset(state=serves[step])
        observation, _, absorbing, info = env.step(action)
        expected = recorded["obs"][step]
        kept = np.isfinite(expected)
        np.testing.assert_allclose(observation[kept], expected[kept], rtol=0.0, atol=bound[step])
        if judged[step]:
            assert absorbing == recorded["absorbing"][step]
            compare_info(info, recorded, step)


def compare_info(info: dict[str, Any], recorded: dict[str, Array], step: int) -> None:
    for key in ("success", "score", "faults"):
        assert (key in info) == (key in recorded)
        if key in info:
            np.testing.assert_array_equal(info[key], recorded[key][step])
    jerk = recorded["jerk"][step]
    if not np.isnan(jerk).any():
        np.testing.assert_allclose(info["jerk"], jerk, rtol=1e-5, atol=0.1)
    values = info["constraints_value"]
    by_name = values
    if isinstance(values, list):
        by_name = {f"{player}_{name}": value for player in range(2) for name, value in values[player].items()}
    assert {f"c_{name}" for name in by_name} == {name for name in recorded if name.startswith("c_")}
    for name, value in by_name.items():
        expected = recorded[f"c_{name}"][step]
        clear = np.abs(expected) > 1e-6  # NaN, which was not kept, is not clear
        np.testing.assert_array_equal(value[clear] > 0, expected[clear] > 0)
        np.testing.assert_allclose(value[clear], expected[clear], rtol=1e-5, atol=1e-5)


def load(path: Path) -> tuple[dict[str, Any], dict[str, Array]]:
    """What the environment is made with, and the recording."""
    with np.load(path, allow_pickle=False) as file:
        recorded = dict(file)
    order = int(recorded["order"])
    arguments = {
        "interpolation_order": None if order == -99 else order,
        "edition": str(recorded.get("edition", "2023")),
    }
    return {"name": str(recorded["env"])} | arguments, recorded


def test_the_recordings_cover_every_environment_and_order_and_are_small() -> None:
    loaded = [load(path)[0] for path in PATHS]
    for edition in available():
        names = {made["name"] for made in loaded if made["edition"] == edition}
        assert names == set(envs.edition(edition).environments)
    for arm in ("3dof", "7dof"):
        orders = {made["interpolation_order"] for made in loaded if made["name"].startswith(arm)}
        assert orders == {1, 2, 3, 4, 5, -1, None}
    assert sum(path.stat().st_size for path in PATHS) < 600_000


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_the_environment_reproduces_a_recording(path: Path) -> None:
    arguments, recorded = load(path)
    replay(envs.make(**arguments), recorded)


@pytest.mark.parametrize("stem", THROUGH_THE_WRAPPER)
def test_the_official_wrapper_reproduces_a_recording(stem: str) -> None:
    arguments, recorded = load(FOLDER / f"{stem}.npz")
    replay(envs.AirHockeyChallengeWrapper(arguments.pop("name"), **arguments), recorded)


def test_without_contact_a_last_bit_stays_small() -> None:
    """So that the bound above means something: only contacts of the planar arm are chaotic."""
    chaotic = {path.stem for path in PATHS if load(path)[1]["chaos"].max() > 1e-9}
    assert chaotic == {"3dof-hit_strike_o3_s1"}
