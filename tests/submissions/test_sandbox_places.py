"""Where software lies, and what a machine can have: a sandbox is there in full, or its lack is said."""

import os
import py_compile
import subprocess
import tempfile
import time
import venv
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import airhockey
from airhockey import envs
from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options
from airhockey.evaluator.isolation import agent_client, modes
from airhockey.evaluator.isolation.build import build_agent
from airhockey.evaluator.isolation.failures import AgentDied, AgentRaised
from airhockey.evaluator.play.episode import EpisodePlayer
from airhockey.evaluator.play.game import GamePlayer
from airhockey.evaluator.runs.game_records import GameJob, GameOptions
from airhockey.evaluator.runs.records import Job
from submissions import make_submission

LOOK = """
import subprocess, sys
from airhockey.evaluator.isolation import sandbox
print(sandbox.why_no_sandbox())
inside = [*sandbox.walls(1 << 20), *sandbox.closing(), sys.executable, "-P", "-c", "import only_here; print(only_here.WORD)"]
print(subprocess.run(inside, capture_output=True, text=True, cwd="/", env=sandbox.software_environment()).stdout)
"""


@pytest.fixture
def python() -> Iterator[str]:
    """The interpreter of a virtual environment below /tmp, which the sandbox has a folder of its own for."""
    with tempfile.TemporaryDirectory(dir="/tmp", prefix="airhockey-venv-") as folder:
        os.chmod(folder, 0o755)
        venv.create(folder, symlinks=True, with_pip=False)
        packages = next(Path(folder).glob("lib/python*/site-packages"))
        (packages / "only_here.py").write_text("WORD = 'found'\n")
        yield str(Path(folder) / "bin" / "python")


def test_a_virtual_environment_below_tmp_has_a_sandbox(python: str, sandbox: None) -> None:
    package = Path(next(iter(airhockey.__path__))).parent
    environment = {**os.environ, "PYTHONPATH": str(package)}
    done = subprocess.run([python, "-P", "-c", LOOK], capture_output=True, text=True, env=environment, timeout=120)
    assert done.stdout.split() == ["None", "found"], done.stderr


def test_a_sandbox_that_is_not_to_be_had_is_the_machines_fault(
    submission: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker elsewhere may lack what the machine that began the run has: no episode is lost to the agent by that."""
    monkeypatch.setattr(modes, "why_no_sandbox", lambda: "no bubblewrap")
    agent, ideal = submission(), load_disturbances("ideal")
    player = EpisodePlayer(Options(environments=("3dof-defend",), agent=agent, isolate="sandbox"), ideal)
    with pytest.raises(ConfigurationError, match="no bubblewrap"):
        player(Job("3dof-defend", 0))
    job = GameJob("0", "home", "away", "hold", agent, seed=1)
    with pytest.raises(ConfigurationError, match="no bubblewrap"):
        GamePlayer(GameOptions(steps=5, isolate="sandbox"), ideal)(job)


def test_the_record_says_what_the_default_got(
    submission: Callable[..., str], sandbox: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = GameJob("0", "home", "away", "hold", submission(), seed=1)
    player = GamePlayer(GameOptions(steps=5, isolate="auto"), load_disturbances("ideal"))
    record = player(job).record
    assert record.home.process.isolation == "none"
    assert record.away.process.isolation.startswith("sandbox (bubblewrap, seccomp, ")
    assert record.away.process.build_time > record.away.process.start_time > 0.0
    monkeypatch.setattr(modes, "why_no_sandbox", lambda: "no bubblewrap")
    assert player(job).record.away.process.isolation.startswith("process (")


def test_an_agent_that_cannot_be_built_is_on_record_with_its_place(bad: Callable[..., str]) -> None:
    agent = bad(importing="raise ValueError('no')")
    player = EpisodePlayer(
        Options(environments=("3dof-defend",), agent=agent, isolate="process"), load_disturbances("ideal")
    )
    record = player(Job("3dof-defend", 0)).record
    assert record.error is not None and record.process.isolation == "process"
    assert record.process.build_time > 0.0


def test_an_agent_that_wastes_hours_by_breaking_down_is_not_built_again(bad: Callable[..., str]) -> None:
    """Its episodes are failed, and an episode's time is given back with each of them."""
    options = Options(environments=("3dof-defend",), agent=bad("os._exit(1)"), isolate="process")
    player = EpisodePlayer(options, load_disturbances("ideal"))
    assert "exit status 1" in str(player(Job("3dof-defend", 0)).record.error)
    player._rebuilding.spent = player._rebuilding.allowed + 15.0
    errors = [str(player(Job("3dof-defend", index)).record.error) for index in range(1, 4)]
    player.close()
    assert ["broke down too often" in error for error in errors] == [True, True, False]
    assert "exit status 1" in errors[2]


def test_compiled_code_that_is_other_than_its_source_is_not_seen(tmp_path: Path, sandbox: None) -> None:
    """Python believes a compiled module that says so; no hash of an entry counts what tools leave in its folder."""
    entry = Path(make_submission(tmp_path, config="interpolation_order: 3\n"))
    source = entry / "agent_builder.py"
    honest = source.read_text()
    source.write_text("raise ValueError('another')\n")
    compiled = py_compile.compile(str(source), invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH)
    source.write_text(honest)
    assert compiled is not None and Path(compiled).parent.name == "__pycache__"
    env = envs.make("3dof-defend")
    agent = build_agent(str(entry), env, mode="sandbox")
    agent.close()


def test_results_of_runs_in_an_entry_are_not_seen(bad: Callable[..., str], sandbox: None) -> None:
    """They do not count, so nobody may play by them: they could be changed while a run waits."""
    folder = Path(bad(building="raise ValueError(sorted(os.listdir('.')), sorted(os.listdir('results')))"))
    for place in ("results", "parts"):
        (folder / place).mkdir()
        (folder / place / "weights.bin").write_text("x")
    (folder / "results" / "run.json").write_text("{}")
    with pytest.raises(AgentRaised, match=r"'parts', 'results'\], \[\]"):
        build_agent(str(folder), envs.make("3dof-defend"), mode="sandbox")


def dies_in_its_third_action(agent: str, words: str) -> None:
    env = envs.make("3dof-hit")
    player = build_agent(agent, env, mode="sandbox")
    player.episode_start()
    observation = env.reset(seed=0)
    for _ in range(2):
        player.act(observation)
    with pytest.raises(AgentDied, match=words):
        player.act(observation)


CONNECTING = """server, kept = socket.create_server(("127.0.0.1", 0), backlog=64), []
while len(kept) < 100:
    kept.append((socket.create_connection(server.getsockname()), server.accept()[0]))
time.sleep(30)"""


def test_connections_to_itself_without_end_are_counted(bad: Callable[..., str], sandbox: None) -> None:
    """What waits in them is the kernel's memory, of which all of a machine has one share."""
    dies_in_its_third_action(bad(CONNECTING), "more than 128 sockets")


def test_empty_files_without_end_are_counted(bad: Callable[..., str], sandbox: None) -> None:
    """They take no space where files lie, but the kernel's memory."""
    making = "for k in range(10**6): os.close(os.open(f'/tmp/{k}', os.O_CREAT))"
    dies_in_its_third_action(bad(making), "more than 20,000 files")


DAEMON = """
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        open(PLACE, 'w').write(str(os.getpid()))
        time.sleep(600)
    os._exit(0)
os.wait()
while not (os.path.exists(PLACE) and open(PLACE).read()): time.sleep(0.01)
"""


def test_nobody_is_left_behind_by_a_process_without_cgroup(
    bad: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whom its children leave behind becomes the agent's own child, and ends with it."""
    monkeypatch.setattr(agent_client, "new_group", lambda *_: None)
    place = tmp_path / "daemon"
    env = envs.make("3dof-defend")
    agent = build_agent(bad(DAEMON.replace("PLACE", repr(str(place))).strip()), env, mode="process")
    agent.episode_start()
    for _ in range(3):
        agent.act(env.reset(seed=0))
    daemon = Path(f"/proc/{place.read_text()}")
    assert daemon.exists() and "rlimits" in agent.isolation
    agent.close()
    end = time.monotonic() + 10.0
    while daemon.exists() and ") Z " not in (daemon / "stat").read_text() and time.monotonic() < end:
        time.sleep(0.01)
    assert not daemon.exists() or ") Z " in (daemon / "stat").read_text()
