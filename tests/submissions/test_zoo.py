"""Every bad submission ends in a verdict for itself alone: the evaluator lives, and reads why."""

import contextlib
import os
import re
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from airhockey import envs
from airhockey.errors import ActionError, AirHockeyError, SimulationError
from airhockey.evaluator.isolation.agent_client import IsolatedAgent
from airhockey.evaluator.isolation.build import build_agent
from airhockey.evaluator.isolation.failures import AgentDied, AgentError, AgentRaised, AgentTimeout
from airhockey.evaluator.isolation.limits import MIB, Limits

MODES = ("process", "sandbox")
LIMITS = Limits(start=60.0, patience=1.0, processes=24, scratch=16 * MIB, file=4 * MIB)


@pytest.fixture(scope="module")
def env() -> Any:
    return envs.make("3dof-hit")


def play(agent: IsolatedAgent, env: Any, steps: int = 6) -> np.ndarray:
    agent.episode_start()
    observation = env.reset(seed=0)
    for _ in range(steps):
        observation, *_ = env.step(agent.act(observation))
    return observation


def ends(folder: str, env: Any, mode: str, kind: type[AirHockeyError], text: str = "", limits: Limits = LIMITS) -> str:
    """The agent fails with an error of this kind, and nothing of it is left."""
    agent = None
    try:
        agent = build_agent(folder, env, mode=mode, limits=limits)
        play(agent, env)
    except kind as failure:
        message = str(failure)
    else:
        pytest.fail("it played")
    finally:
        if agent is not None:
            agent.close()
    assert re.search(text, message)
    assert agent is None or gone(agent)
    return message


def gone(agent: IsolatedAgent) -> bool:
    """Whether its process has ended."""
    deadline = time.monotonic() + 5.0
    while time.monotonic() < deadline:
        try:
            os.kill(agent._pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.01)
    return False


@pytest.mark.parametrize(
    ("kind", "text", "where"),
    [
        (AgentRaised, "ZeroDivisionError", {"importing": "1 / 0"}),
        (AgentRaised, "neither a file of the submission nor a package", {"importing": "import nowhere_to_be_found"}),
        (AgentRaised, "SystemExit", {"building": "sys.exit(3)"}),
        (AgentDied, "exit status 7.*last words: farewell", {"building": "print('farewell'); os._exit(7)"}),
    ],
)
def test_one_that_does_not_load_says_why(
    env: Any, sandbox: None, bad: Callable[..., str], kind: Any, text: str, where: dict[str, str]
) -> None:
    ends(bad(**where), env, "sandbox", kind, text)


def test_one_that_never_loads_is_stopped(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    ends(bad(importing="while True: pass"), env, "sandbox", AgentTimeout, "4 s", Limits(start=4.0))


ACTS = {
    "raises": (AgentRaised, r"KeyError: 'no'.*agent_builder.py", "{}['no']"),
    "leaves": (AgentRaised, "SystemExit", "sys.exit()"),
    "is gone": (AgentDied, "exit status 5", "os._exit(5)"),
    "loops": (AgentTimeout, "within 0.5 s", "while True: pass"),
    "sleeps": (AgentTimeout, "within 0.5 s", "time.sleep(100)"),
    "says a word": (ActionError, "dtype <U", "action = 'left'"),
    "is ragged": (ActionError, "not an array of numbers", "action = [[1.0], [1.0, 2.0]]"),
    "has another shape": (ActionError, r"shape \(5, 2\)", "action = np.zeros((5, 2))"),
    "is huge": (ActionError, "shape", "action = np.zeros((3000, 30))"),
    "is not a number": (ActionError, "not finite", "action = action * np.nan"),
    "is infinite": (ActionError, "not finite", "action = action + np.inf"),
    "takes 8 GB": (AgentRaised, "MemoryError", "np.ones(1 << 30)"),
    "opens every file": (AgentRaised, "Too many open files", "self.f = [open('/dev/null') for _ in range(100000)]"),
    "writes a large file": (
        AgentRaised,
        "File too large|No space",
        "open(tempfile.gettempdir() + '/x', 'wb').write(bytes(1 << 25))",
    ),
    "aborts": (AgentDied, "signal", "ctypes.string_at(0)"),
}


@pytest.mark.parametrize("name", ACTS)
def test_one_that_fails_at_a_step_says_why(env: Any, sandbox: None, bad: Callable[..., str], name: str) -> None:
    kind, text, act = ACTS[name]
    ends(bad(act), env, "sandbox", kind, text, Limits(start=60.0, patience=0.5, scratch=16 * MIB, file=4 * MIB))


@pytest.mark.parametrize("name", ["raises", "is gone", "loops", "takes 8 GB", "opens every file"])
def test_a_process_without_a_sandbox_does_as_much(env: Any, bad: Callable[..., str], name: str) -> None:
    kind, text, act = ACTS[name]
    ends(bad(act), env, "process", kind, text, Limits(start=60.0, patience=0.5))


HARMLESS = {
    "signals to everybody": """
for s in (signal.SIGTERM, signal.SIGKILL):
    for p in (os.getppid(), -1):
        try: os.kill(p, s)
        except OSError: pass
""",
    "output without end": "for _ in range(200):\n    sys.stdout.write('x' * 1000000); sys.stderr.write('y' * 1000)",
    "a changed env_info": "self.env_info['robot']['joint_vel_limit'][:] = 1e9; self.env_info.clear()",
    "a patched clock": "time.perf_counter = time.monotonic = time.time = lambda: 0.0",
    "an observation overwritten": "observation[:] = np.nan",
}


@pytest.mark.parametrize("name", HARMLESS)
def test_what_it_does_to_itself_hurts_nobody(env: Any, sandbox: None, bad: Callable[..., str], name: str) -> None:
    quiet, loud = bad(), bad(HARMLESS[name])
    limit = np.array(env.env_info["robot"]["joint_vel_limit"])
    results = []
    for folder in (quiet, loud):
        agent = build_agent(folder, env, mode="sandbox", limits=Limits(start=60.0, patience=20.0))
        results.append(play(agent, env))
        agent.stop()
        assert gone(agent)
    np.testing.assert_array_equal(*results)
    np.testing.assert_array_equal(env.env_info["robot"]["joint_vel_limit"], limit)


def test_a_patched_numpy_fails_only_its_owner(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    ends(bad("np.asarray = np.array = None"), env, "sandbox", AirHockeyError, "not callable")


def test_a_command_beyond_all_bounds_breaks_no_engine(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    agent = build_agent(bad("action = action + 1e300"), env, mode="sandbox", limits=LIMITS)
    try:
        assert np.isfinite(play(agent, env)).all()
    except (ActionError, SimulationError):
        pass  # a verdict too
    finally:
        agent.close()
    assert np.isfinite(env.reset(seed=1)).all()


def test_last_steps_array_is_its_own(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    folder = bad("self.kept = observation; self.copy = observation.copy()")
    builder = Path(folder) / "agent_builder.py"
    check = "assert self.step < 4 or (self.kept == self.copy).all()"
    builder.write_text(builder.read_text().replace("return action", f"{check}\n        return action"))
    agent = build_agent(folder, env, mode="sandbox", limits=LIMITS)
    play(agent, env, steps=20)
    agent.close()


FILLING = """frame = sys._getframe()
while 'nonce' not in frame.f_locals: frame = frame.f_back
names = frame.f_locals
again = os.open(f"/proc/self/fd/{names['requests']}", os.O_WRONLY | os.O_NONBLOCK)
try:
    while True: os.write(again, bytes(4096))
except BlockingIOError: os.write(names['replies'], b'K' + names['nonce'])
time.sleep(1000)"""


def test_a_pipe_that_it_filled_keeps_nobody_waiting(env: Any, bad: Callable[..., str]) -> None:
    ends(
        bad(FILLING), env, "process", AgentError, "filled the pipe"
    )  # in a sandbox of root's the pipe is another user's


def test_a_message_to_the_evaluator_is_data(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    spoof = "import gc, fcntl\nfor f in range(3, 20):\n    try: os.write(f, b'!')\n    except OSError: pass"
    agent = build_agent(bad(spoof), env, mode="sandbox", limits=LIMITS)
    # Whether the false answer comes before the true one is a race; either way it is checked like any answer.
    with contextlib.closing(agent), contextlib.suppress(AgentError):
        assert np.isfinite(play(agent, env)).all()
    assert gone(agent)


def probe(env: Any, bad: Callable[..., str], code: str, limits: Limits = LIMITS) -> str:
    """What the code, run in a sandbox at the first step, raises."""
    return ends(bad(f"{code}\nraise RuntimeError('it did: ' + repr(seen))"), env, "sandbox", AgentRaised, "", limits)


def test_nothing_outside_can_be_read_or_written(
    env: Any, sandbox: None, bad: Callable[..., str], tmp_path: Path
) -> None:
    secret = tmp_path / "opponent" / "agent_builder.py"
    secret.parent.mkdir()
    secret.write_text("secret")
    code = f"""
seen = []
for path in ({str(secret)!r}, '/etc/passwd', '/root/.ssh', '/home', {str(Path.cwd() / "README.md")!r}):
    if os.path.exists(path): seen.append(path)
for path in ('/', '/submission', '/submission/air_hockey_agent', '/dev', '/usr', os.path.dirname(np.__file__)):
    try:
        open(os.path.join(path, 'written'), 'w')
        seen.append(path)
    except OSError: pass
if len([p for p in os.listdir('/proc') if p.isdigit()]) > 2: seen.append('processes')  # bubblewrap's and this
for name in os.environ:
    if name not in {sorted(ENVIRONMENT)!r}: seen.append(name)
open(tempfile.gettempdir() + '/mine', 'w').write('x')
if len(os.listdir('/proc/self/task')) > 4: seen.append('threads')
"""
    assert probe(env, bad, code).startswith("RuntimeError: it did: [] ")


ENVIRONMENT = [
    "PATH",
    "HOME",
    "TMPDIR",
    "LANG",
    "PYTHONPATH",
    "PYTHONDONTWRITEBYTECODE",
    "PYTHONUNBUFFERED",
    "MPLCONFIGDIR",
    "NUMBA_CACHE_LOCATOR_CLASSES",
    "PWD",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "LC_CTYPE",
    "KMP_DUPLICATE_LIB_OK",
    "KMP_INIT_AT_FORK",
    "CPU_COUNT",
]


def test_a_pickle_that_executes_code_does_so_in_the_sandbox(
    env: Any, sandbox: None, bad: Callable[..., str], tmp_path: Path
) -> None:
    mark = tmp_path / "mark"
    folder = bad(
        building=f"""import pickle
    open(tempfile.gettempdir() + '/a.msh', 'wb').write(pickle.dumps(Bomb({str(mark)!r})))
    pickle.load(open(tempfile.gettempdir() + '/a.msh', 'rb'))""",
        importing=BOMB,
    )
    ends(folder, env, "sandbox", AgentDied, "exit status 9")
    assert not mark.exists()


BOMB = """
class Bomb:
    def __init__(self, mark): self.mark = mark
    def __reduce__(self): return exec, (f"import os\\nos.system('touch {self.mark}')\\nos._exit(9)",)
"""


def test_there_is_no_network(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    import socket

    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        code = f"""
seen = []
for address in (('127.0.0.1', {port}), ('1.1.1.1', 53)):
    try: socket.create_connection(address, 0.2); seen.append(address)
    except OSError: pass
"""
        assert probe(env, bad, code).startswith("RuntimeError: it did: [] ")


def test_threads_and_processes_are_counted(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    code = """
seen, children = 0, []
try:
    for _ in range(40):
        children.append(subprocess.Popen(['sleep', '100']))
        seen += 1
except OSError: pass
"""
    message = probe(env, bad, code, Limits(start=60.0, patience=20.0, processes=24))
    assert 5 <= int(message.split("it did: ")[1].split()[0]) < 24


def test_a_fork_bomb_ends_with_its_sandbox(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    bomb = """
while True:
    try: os.fork()
    except OSError: time.sleep(0.01)
"""
    before = len(own_processes())
    ends(bad(bomb), env, "sandbox", AgentError, "", Limits(start=60.0, patience=1.0, processes=16))
    deadline = time.monotonic() + 10.0
    while len(own_processes()) > before + 2 and time.monotonic() < deadline:
        time.sleep(0.05)
    assert len(own_processes()) <= before + 2


def own_processes() -> list[str]:
    """Processes that run an agent."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                command = (entry / "cmdline").read_bytes()
            except OSError:
                continue
            if b"airhockey.evaluator.isolation.agent_process" in command:
                found.append(entry.name)
    return found


def test_all_files_together_have_a_limit(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    code = """
seen = 0
try:
    for k in range(40):
        for place in (tempfile.gettempdir(), '/dev/shm'):
            open(f'{place}/{k}', 'wb').write(bytes(1 << 20)); seen += 1
except OSError: pass
"""
    assert int(probe(env, bad, code).split("it did: ")[1].split()[0]) <= 33


def test_an_agent_ends_with_the_evaluator(env: Any, sandbox: None, bad: Callable[..., str]) -> None:
    folder = bad("while True: pass")
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        agent = build_agent(folder, env, mode="sandbox", limits=Limits())
        os.write(writer, str(agent._pid).encode())
        play(agent, env)
    os.close(writer)
    pid = int(os.read(reader, 100))
    os.close(reader)
    time.sleep(0.3)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    deadline = time.monotonic() + 5.0
    while Path(f"/proc/{pid}/stat").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not Path(f"/proc/{pid}/stat").exists()
