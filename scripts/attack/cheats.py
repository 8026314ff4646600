"""Entries that want a better result than their play deserves: time for nothing, and knowledge of the future."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import product
from verdicts import ESCAPE, HANG, HELD, LEFTOVER, TRACEBACK, Verdict

LIMIT = 0.02
"""What an answer may take, in [s]: every cheat below takes more, and is caught where this is seen."""
HEAD = """
import os, random, signal, subprocess, sys, threading, time
import numpy as np
from airhockey.agents import build_agent as build

def compute(seconds, clock=time.process_time):
    end = clock() + seconds
    while clock() < end:
        pass

class Base:
    interpolation_order = 3
    def __init__(self, env_info, **kwargs):
        self.agent = build("hold", env_info, kwargs.get("agent_id", 1))
        self.steps = 0
    def episode_start(self):
        self.agent.episode_start()
    def draw_action(self, observation):
        self.steps += 1
        if self.steps % 50 < 3:
            self.cheat(observation)
        return self.agent.draw_action(observation)
    def cheat(self, observation):
        pass

class Employer(Base):
    # Lets another process work, which `hire` makes; it gives True there.
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        self.done, done = os.pipe()
        asked, self.asked = os.pipe()
        if self.hire():
            while os.read(asked, 1):
                compute(0.06)
                os.write(done, b"x")
            os._exit(0)
    def cheat(self, observation):
        os.write(self.asked, b"x")
        os.read(self.done, 1)

def frames():
    frame = sys._getframe()
    while frame:
        yield frame
        frame = frame.f_back
"""
TAIL = """
def build_agent(env_info, **kwargs):
    return Agent(env_info, **kwargs)
"""


@dataclass(frozen=True)
class Cheat:
    """An entry that computes too long.

    Attributes:
        code: Its class `Agent`.
        clock: Which clock it wants to deceive.
    """

    code: str
    clock: str = "cpu"


TIME = {
    "work in a child": Cheat("""
class Agent(Employer):
    def hire(self):
        return os.fork() == 0
"""),
    "work in a grandchild that nobody waits for": Cheat("""
class Agent(Employer):
    def hire(self):
        if os.fork() == 0:
            os.setsid()
            if os.fork() == 0:
                return True
            os._exit(0)
        os.wait()
        return False
"""),
    "a new child for every step": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        child = os.fork()
        if child == 0:
            compute(0.06)
            os._exit(0)
        os.waitpid(child, 0)
"""),
    "children that nobody waits for": Cheat("""
class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    def cheat(self, observation):
        reader, writer = os.pipe()
        if os.fork() == 0:
            compute(0.06)
            os.write(writer, b"x")
            os._exit(0)
        os.read(reader, 1)
        os.close(reader)
        os.close(writer)
        time.sleep(0.005)
"""),
    "a program for every step": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        subprocess.run([sys.executable, "-ISc", "import time\\nwhile time.process_time() < 0.06: pass"], check=True)
"""),
    "work in threads": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        threads = [threading.Thread(target=compute, args=(0.06,)) for _ in range(2)]
        [thread.start() for thread in threads]
        [thread.join() for thread in threads]
"""),
    "a thread that works between the steps": Cheat("""
class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        threading.Thread(target=self.work, daemon=True).start()
    def work(self):
        while True:
            compute(1.0)
    def cheat(self, observation):
        if self.steps % 5 == 0:
            time.sleep(0.06)
"""),
    "sleep at every step": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        if self.steps % 5 == 0:
            time.sleep(0.3)
"""),
    "wait for a file that never comes": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        if self.steps % 5 == 0:
            end = time.monotonic() + 0.3
            while time.monotonic() < end and not os.path.exists("/tmp/never"):
                time.sleep(0.0002)
"""),
    "replies written in advance": Cheat("""
class Agent(Base):
    def draw_action(self, observation):
        self.steps += 1
        action = self.agent.draw_action(observation)
        if self.steps == 1:
            for frame in frames():
                for value in list(frame.f_locals.values()):
                    if hasattr(value, "write_action"):
                        value.write_action(action)
            for fd in range(3, 64):
                try:
                    os.set_blocking(fd, False)
                    os.write(fd, b"K" * 60000)
                except OSError:
                    pass
                try:
                    os.set_blocking(fd, True)
                except OSError:
                    pass
        if self.steps % 50 < 3:
            compute(0.05)
        return action
"""),
    "replies written by a thread": Cheat("""
class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        threading.Thread(target=self.reply, daemon=True).start()
    def reply(self):
        while True:
            time.sleep(0.001)
            for fd in range(3, 64):
                try:
                    if not os.get_blocking(fd) or "pipe" in os.readlink(f"/proc/self/fd/{fd}"):
                        os.write(fd, b"K")
                except OSError:
                    pass
    def cheat(self, observation):
        compute(0.05)
"""),
    "the reply first, the work afterwards": Cheat("""
class Agent(Base):
    def draw_action(self, observation):
        self.steps += 1
        action = self.agent.draw_action(observation)
        if self.steps == 2:
            for frame in frames():
                server = frame.f_locals.get("self")
                if type(server).__name__ == "Server":
                    whole = type(server).answer
                    def answer(self, word, *rest, whole=whole):
                        threading.Thread(target=compute, args=(0.05,)).start()
                        return whole(self, word, *rest)
                    type(server).answer = answer
        return action
"""),
    "a clock of its own": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        began = time.process_time()
        time.perf_counter = time.process_time = time.thread_time = time.monotonic = lambda: 0.0
        for _ in range(20):
            sum(range(200_000))
"""),
    "a child that answers in its place": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        if self.steps == 2:
            child = os.fork()
            if child:
                os.waitpid(child, 0)
                os._exit(0)
        if self.steps > 2:
            compute(0.06)
"""),
    "many short children": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        for _ in range(24):
            child = os.fork()
            if child == 0:
                compute(0.003)
                os._exit(0)
            os.waitpid(child, 0)
"""),
    "work at the lowest priority": Cheat("""
class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        os.nice(19)
    def cheat(self, observation):
        compute(0.06)
"""),
    "work whenever a child is born": Cheat("""
class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        os.register_at_fork(after_in_child=lambda: compute(0.06))
    def cheat(self, observation):
        child = os.fork()
        if child == 0:
            os._exit(0)
        os.waitpid(child, 0)
"""),
    "work in a destructor": Cheat("""
class Late:
    def __del__(self):
        compute(0.06)
class Agent(Base):
    def draw_action(self, observation):
        late = Late()
        return self.agent.draw_action(observation)
"""),
    "work in the finding of its own answer": Cheat("""
class Lazy:
    def __init__(self, action):
        self.action = action
    def __array__(self, *given, **named):
        compute(0.06)
        return self.action
class Agent(Base):
    def draw_action(self, observation):
        return Lazy(self.agent.draw_action(observation))
"""),
    "work in an attribute that is asked for": Cheat("""
class Agent(Base):
    @property
    def draw_action(self):
        compute(0.06)
        return self.agent.draw_action
"""),
    "work when a signal comes": Cheat("""
class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        signal.signal(signal.SIGALRM, lambda *_: compute(0.06))
    def cheat(self, observation):
        signal.setitimer(signal.ITIMER_REAL, 0.0005)
        time.sleep(0.001)
"""),
    "work in a trace of every line": Cheat("""
class Agent(Base):
    def cheat(self, observation):
        sys.settrace(lambda *_: compute(0.06))
        int("3")
        (lambda: 0)()
        sys.settrace(None)
"""),
    "work in a collection of garbage": Cheat("""
import gc
class Agent(Base):
    def cheat(self, observation):
        gc.callbacks[:] = [lambda phase, _: compute(0.03)]
        gc.collect()
"""),
    "computing in preprocessors": Cheat("""
class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        self.preprocessors = [self.prepare]
    def prepare(self, observation):
        compute(0.06)
        return observation
"""),
}
WAITS = {
    "a builder that takes its time": """
class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        time.sleep(1000)
""",
    "a start of an episode that takes its time": """
class Agent(Base):
    def episode_start(self):
        super().episode_start()
        compute(40.0, time.monotonic)
""",
    "a start of an episode that sleeps": """
class Agent(Base):
    def episode_start(self):
        super().episode_start()
        time.sleep(40.0)
""",
    "an agent that stops itself": """
class Agent(Base):
    def cheat(self, observation):
        os.kill(os.getpid(), signal.SIGSTOP)
""",
    "an agent that stops its whole group": """
class Agent(Base):
    def cheat(self, observation):
        os.killpg(0, signal.SIGSTOP)
""",
    "an agent that closes every descriptor and waits": """
class Agent(Base):
    def cheat(self, observation):
        os.closerange(0, 256)
        time.sleep(1000)
""",
    "an agent that is killed and killed again": """
class Agent(Base):
    def episode_start(self):
        os.kill(os.getpid(), signal.SIGKILL)
""",
    "an agent that fills the pipe of its requests": """
class Agent(Base):
    def cheat(self, observation):
        for frame in frames():
            names = frame.f_locals
            if "nonce" in names:
                pipe = os.open(f"/proc/self/fd/{names['requests']}", os.O_WRONLY | os.O_NONBLOCK)
                try:
                    while True:
                        os.write(pipe, bytes(4096))
                except BlockingIOError:
                    os.write(names["replies"], b"K" + names["nonce"])
        time.sleep(1000)
""",
    "an agent whose threads never let go": """
class Agent(Base):
    def cheat(self, observation):
        sys.setswitchinterval(1e6)
        threading.Thread(target=compute, args=(1e6,)).start()
        time.sleep(1000)
""",
    "steps just within the patience": """
class Agent(Base):
    def draw_action(self, observation):
        time.sleep(3.0)
        return self.agent.draw_action(observation)
""",
}
"""Entries that make others wait: with a patience of 4 s, all of it must end soon, and be on record."""
ACTIONS = {
    "no action at all": "None",
    "objects": "np.array([[object()] * 3] * 2, dtype=object)",
    "not a number": "np.full((2, 3), np.nan)",
    "infinite": "np.full((2, 3), np.inf)",
    "complex": "np.ones((2, 3)) * 1j",
    "truth values": "np.ones((2, 3), dtype=bool)",
    "text": "np.array([['1.0'] * 3] * 2)",
    "dates": "np.zeros((2, 3), dtype='datetime64[s]')",
    "records": "np.zeros((2, 3), dtype=[('a', float)])",
    "an array without end": "np.broadcast_to(np.float64(0), (2, 10**12))",
    "gigabytes": "np.zeros((2, 3, 10**7))",
    "many dimensions": "np.zeros((1,) * 30)",
    "a shape of nothing": "np.zeros((0, 3))",
    "an iterator": "iter(range(10**9))",
    "a list that holds itself": "(lambda one: (one.append(one), one)[1])([])",
    "an array that is another each time it is asked for": "Shifty()",
    "an array that raises": "Raising()",
    "an array that ends the program": "Ending()",
    "numbers beyond float64": "np.full((2, 3), np.longdouble('1e4000'))",
    "whole numbers beyond float64": "[[10**400] * 3] * 2",
    "a file that is not there any more": "gone()",
    "a memory that was let go": "(lambda m: (np.frombuffer(m, float, 6).reshape(2, 3) * np.nan))(bytearray(48))",
    "a number that says it is an array": "type('A', (float,), {'shape': (2, 3), '__len__': lambda self: 2})(0.0)",
    "an interface to an address of nowhere": "Nowhere()",
    "a list of lists of itself": "(lambda one: (one.extend([one, one]), one)[1])([])",
}
"""Actions that are none, as an expression; each fails the agent, and nobody else."""
ODD = """
import tempfile
class Shifty:
    count = 0
    def __array__(self, *given, **named):
        Shifty.count += 1
        return np.zeros((Shifty.count, 7, 9))
class Raising:
    def __array__(self, *given, **named):
        raise BaseException("\\x1b[2J[red]")
class Nowhere:
    __array_interface__ = {"shape": (2, 3), "typestr": "<f8", "data": (8, False), "version": 3}
class Ending:
    def __array__(self, *given, **named):
        sys.exit(0)
def gone():
    with tempfile.NamedTemporaryFile() as file:
        file.write(bytes(4096)); file.flush()
        there = np.memmap(file.name, dtype=float, mode="r+", shape=(2, 3))
        os.truncate(file.name, 0)
        return there
class Agent(Base):
    def draw_action(self, observation):
        self.steps += 1
        return ACTION if self.steps == 3 else self.agent.draw_action(observation)
"""
ORACLE = """
import zlib
from airhockey import envs

def words():
    for frame in frames():
        for value in frame.f_locals.values():
            if isinstance(value, dict) and "seed" in value:
                return value["seed"]
    return None

class Agent(Base):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        self.told = [words()]
        self.state = np.random.get_state()[1][:8].copy()
        self.env = envs.make("3dof-hit", 3)
        self.found = None
    def episode_start(self):
        super().episode_start()
        self.told.append(words())
        self.drawn = np.random.get_state()[1].copy()
        self.steps = 0
    def cheat(self, observation):
        if self.steps != 1:
            return
        spawn = (zlib.crc32(b"3dof-hit"), 0)
        for seed in range(3000):
            for owner in (0, 1, 2):
                there = np.random.SeedSequence(seed, spawn_key=(*spawn, owner)).generate_state(4)
                np.random.seed(there)
                if any(told is not None and list(told)[:4] == there.tolist() for told in self.told) or (
                    (np.random.get_state()[1] == self.drawn).all()
                ):
                    print("@@FOUND", seed, owner, flush=True)
                    return
"""


SEEDS = {"from its own seed, --seed 7": "7", "from its own seed, --seed random": "random"}


def attack(sample: bool) -> Iterator[Verdict]:
    """Play with each cheat, and look at what is on record."""
    for name in product.wanted(TIME)[: 1 if sample else None]:
        cheat = TIME[name]
        options = ("--clock", cheat.clock, "--seed", "1", "--json")
        yield _evaluated("cheats with time", name, cheat.code, options, _is_charged)
    for name in () if sample else product.wanted(WAITS):
        options = ("--patience", "4", "--seed", "1")
        yield _evaluated("entries that make others wait", name, WAITS[name], options, _is_thrown_out, patience=400.0)
    for name in ("an array that ends the program",) if sample else product.wanted(ACTIONS):
        code = ODD.replace("ACTION", ACTIONS[name])
        yield _evaluated("actions that are none", name, code, ("--seed", "1"), _is_thrown_out)
    for name in () if sample else product.wanted(SEEDS):
        yield _evaluated("knowing the future", name, ORACLE, ("--seed", SEEDS[name]), _knows_nothing)


Judge = Callable[[product.Done], tuple[bool, str]]
"""From how an evaluation ended to whether the product held, and what it said."""


def _evaluated(
    kind: str, name: str, code: str, options: tuple[str, ...], judge: Judge, patience: float = product.PATIENCE
) -> Verdict:
    """Evaluate an entry over an episode, and judge how that ended."""
    with product.fresh_place() as place:
        done = place.hockey(
            *("evaluate", "--env", "3dof-hit", "--agent", str(make_entry(place.path, code)), "--episodes", "1"),
            *("--jobs", "1", "--quiet", "--out", "run", *options),
            patience=patience,
        )
    bad = trouble(kind, name, done)
    if bad is not None:
        return bad
    if "\x1b[2J" in done.out + done.err:
        return Verdict(kind, name, ESCAPE, "control sequences reached the terminal")
    held, said = judge(done)
    return Verdict(kind, name, HELD if held else ESCAPE, said)


def _is_thrown_out(done: product.Done) -> tuple[bool, str]:
    return done.status == 3, product.last_line(done)


def _is_charged(done: product.Done) -> tuple[bool, str]:
    """A cheat is caught where its longest answer is known to be too long, or where it is thrown out."""
    if done.status == 3:
        return True, "thrown out"
    longest = json.loads(done.out)["computation_time"]["max"]
    return longest > LIMIT, f"longest answer {longest * 1e3:.1f} ms"


def _knows_nothing(done: product.Done) -> tuple[bool, str]:
    found = [line for line in done.err.splitlines() if "@@FOUND" in line]
    return done.status in (0, 3) and not found, found[0] if found else product.last_line(done)


def trouble(kind: str, name: str, done: product.Done) -> Verdict | None:
    """What is wrong with how a command ended, whatever it was to do."""
    if done.status is None:
        return Verdict(kind, name, HANG, product.last_line(done))
    if done.has_traceback:
        return Verdict(kind, name, TRACEBACK, product.last_line(done))
    if done.leftovers:
        return Verdict(kind, name, LEFTOVER, ", ".join(done.leftovers))
    return None


def make_entry(place: Path, code: str) -> Path:
    """An entry's folder with this class `Agent`."""
    entry = place / "entry"
    entry.mkdir()
    (entry / "agent_builder.py").write_text(HEAD + code + TAIL)
    (entry / "submission.yaml").write_text("name: entry\nversion: 0.1.0\ninterpolation_order: 3\ntasks: [3dof-hit]\n")
    return entry
