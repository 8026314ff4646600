"""A run is of what it began with: an agent that is edited meanwhile is another agent."""

import json
import os
import shutil
from importlib import resources
from pathlib import Path

import msgspec
import pytest
from command_line import Hockey

from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options
from airhockey.evaluator.evaluation import begin, evaluate, resume
from airhockey.evaluator.match import MatchOptions, begin_match, resume_match
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


def test_an_archive_that_was_packed_anew_is_another_agent(tmp_path: Path) -> None:
    agent, archive = make_submission(tmp_path), tmp_path / "mine.zip"
    shutil.make_archive(str(tmp_path / "mine"), "zip", agent)
    begin(options(str(archive)), tmp_path / "run").close()
    times = archive.stat()
    builder = Path(agent, "agent_builder.py")
    builder.write_text(builder.read_text().replace("0.002", "0.003"))
    shutil.make_archive(str(tmp_path / "mine"), "zip", agent)
    os.utime(archive, ns=(times.st_atime_ns, times.st_mtime_ns))
    with pytest.raises(ConfigurationError, match=r"another content of '.*mine.zip'"):
        resume(tmp_path / "run")


def test_a_parameter_file_that_was_edited_is_refused(tmp_path: Path) -> None:
    parameters = tmp_path / "mine.yaml"
    parameters.write_bytes((resources.files("airhockey.agents.thesis") / "tuned.yaml").read_bytes())
    begin(Options(environments=("3dof-hit",), agent="thesis", parameters=str(parameters)), tmp_path / "run").close()
    parameters.write_text(parameters.read_text() + "\n")
    with pytest.raises(ConfigurationError, match=r"another content of '.*mine.yaml'"):
        resume(tmp_path / "run")


def test_an_edited_profile_changes_nothing_of_a_run_that_has_begun(tmp_path: Path) -> None:
    profile = tmp_path / "mine.yaml"
    profile.write_text("profile: mine\npuck: {position: 0.01}\n")
    asked = Options(environments=("3dof-hit",), agent="hold", episodes=2, disturbances=str(profile))
    begin(asked, tmp_path / "run").close()
    profile.write_text("profile: mine\npuck: {position: 0.5}\n")
    with pytest.raises(ConfigurationError, match="when their content was another"):
        resume(tmp_path / "run", {"disturbances": str(profile)})
    with resume(tmp_path / "run") as folder:
        assert folder.manifest.profile.puck.position == 0.01


def test_results_and_reports_say_by_content_who_played(tmp_path: Path, hockey: Hockey) -> None:
    one, two = make_submission(tmp_path), make_submission(tmp_path, "pass  # another")
    hashes = {one: content_hash(one), two: content_hash(two)}
    end = "--jobs 1 --isolate none --quiet --out"
    status, out, _ = hockey(f"evaluate --env 3dof-hit --agent {one} --episodes 1 {end} run")
    assert (status, hashes[one] in out) == (0, True)
    assert json.loads(Path("run/result.json").read_text())["inputs"] == {one: hashes[one]}
    status, out, _ = hockey(f"match {one} {two} --steps 30 {end} match")
    assert status == 0 and all(digest in out for digest in hashes.values())
    assert json.loads(Path("match/result.json").read_text())["inputs"] == hashes
    status, out, _ = hockey(f"tournament {one} {two} --steps 10 {end} cup")
    assert status == 0 and all(digest in out for digest in hashes.values())
    assert json.loads(Path("cup/standings.json").read_text())["inputs"] == hashes
    for folder, shown in (("run", [one]), ("match", [one, two]), ("cup", [one, two])):
        assert hockey(f"report {folder} -o {folder}.html --quiet")[0] == 0
        page = Path(f"{folder}.html").read_text()
        assert all(hashes[agent] in page for agent in shown) and str(tmp_path) not in page


@pytest.mark.parametrize("given", ["mine", "./mine", "mine/../mine"])
def test_an_agent_by_a_relative_path_is_known_by_its_content_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "agent_builder.py").write_text("x = 1\n")
    begin(options(given), tmp_path / "run").close()
    begin_match(MatchOptions(home="hold", away=given), tmp_path / "match").close()
    (tmp_path / "mine" / "agent_builder.py").write_text("x = 2\n")
    for again, name in ((resume, "run"), (resume_match, "match")):
        with pytest.raises(ConfigurationError, match=r"another content of '/.*/mine'"):
            again(tmp_path / name, {})


def test_a_path_that_is_no_text_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    agent = os.fsdecode(os.fsencode(tmp_path) + b"/\xff\xfe")
    os.mkdir(agent)
    Path(agent, "agent_builder.py").write_text("x = 1\n")
    with pytest.raises(ConfigurationError, match=r"\\udcff\\udcfe is not UTF-8 text"):
        begin(options(agent), tmp_path / "run")
    assert not (tmp_path / "run").exists()
