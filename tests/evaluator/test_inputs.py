"""A run is of what it began with: an agent that is edited meanwhile is another agent."""

from pathlib import Path

import msgspec
import pytest

from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options
from airhockey.evaluator.evaluation import begin, evaluate, resume
from airhockey.evaluator.match import MatchOptions, begin_match
from airhockey.evaluator.runs.inputs import hashes_of
from airhockey.inputs.hashing import content_hash
from submissions import make_submission


def options(agent: str) -> Options:
    return Options(environments=("3dof-hit",), agent=agent, episodes=2)


def test_an_edited_agent_is_refused_by_name_on_resume(tmp_path: Path) -> None:
    agent = make_submission(tmp_path)
    folder = begin(options(agent), tmp_path / "run")
    assert folder.manifest.inputs == {agent: content_hash(agent)}
    folder.close()
    resume(tmp_path / "run").close()
    builder = Path(agent, "agent_builder.py")
    before = builder.read_text()
    builder.write_text(before.replace("0.002", "0.004"))
    with pytest.raises(ConfigurationError, match=f"began with another content of '{agent}'"):
        resume(tmp_path / "run")
    builder.write_text(before)
    resume(tmp_path / "run").close()
    builder.rename(tmp_path / "elsewhere.py")
    Path(agent).rmdir()
    with pytest.raises(ConfigurationError, match="is gone"):
        resume(tmp_path / "run")


def test_an_agent_edited_while_it_plays_gives_no_result(tmp_path: Path) -> None:
    agent = make_submission(tmp_path)
    folder = begin(options(agent), tmp_path / "run")
    builder = Path(agent, "agent_builder.py")
    with pytest.raises(ConfigurationError, match="one result would come from two"):
        evaluate(folder, on_episode=lambda _: builder.write_text(builder.read_text() + "\n") and None)
    assert not (tmp_path / "run" / "result.json").exists()


def test_every_file_that_options_name_is_known_but_disturbances_which_are_kept_whole(tmp_path: Path) -> None:
    home, away = make_submission(tmp_path), make_submission(tmp_path, "pass  # another")
    profile = tmp_path / "mine.yaml"
    profile.write_text("{}")
    asked = MatchOptions(home=home, away=away)
    asked = msgspec.structs.replace(asked, game=msgspec.structs.replace(asked.game, disturbances=str(profile)))
    assert set(hashes_of(asked)) == {home, away}
    assert hashes_of(Options(environments=("3dof-hit",), agent="thesis", parameters=str(profile))) == {
        str(profile): content_hash(profile)
    }


def test_a_link_in_an_entry_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    agent = make_submission(tmp_path)
    Path(agent, "weights.bin").symlink_to("/etc/passwd")
    for start in (
        lambda out: begin(options(agent), out),
        lambda out: begin_match(MatchOptions(home="hold", away=agent), out),
    ):
        with pytest.raises(ConfigurationError, match=r"weights.bin' is a link; put the file itself there"):
            start(tmp_path / "run")
    assert not (tmp_path / "run").exists()
