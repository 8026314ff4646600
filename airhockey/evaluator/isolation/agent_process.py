"""The agent's side: a child process that builds one agent and answers for it.

    python -m airhockey.evaluator.isolation.agent_process REQUESTS REPLIES MEMORY      (file descriptors)

It limits itself and gives up what rights it has before it loads anything of the agent.
"""

import os
import sys
from typing import Any

import numpy as np

from airhockey.evaluator.isolation import channel
from airhockey.evaluator.isolation.channel import Memory
from airhockey.evaluator.isolation.failures import describe
from airhockey.evaluator.isolation.restrict import Restrictions


def main() -> None:
    """Serve until the evaluator hangs up."""
    requests, replies, descriptor = (int(argument) for argument in sys.argv[1:4])
    del sys.argv[1:]  # an agent that reads the command line is not to find ours
    memory = Memory(descriptor)
    os.close(descriptor)
    for pipe in (requests, replies):
        os.set_inheritable(pipe, False)
    server = Server(memory)
    os.write(replies, channel.HELLO)
    while request := os.read(requests, channel.MESSAGE):
        word, nonce = request[:1], request[1:]
        os.write(replies, server.answer(word) + nonce)
        if word == channel.STOP:
            break
    os._exit(0)  # threads of the agent do not keep it alive


class Server:
    """Answers the evaluator's requests."""

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        self._agent: Any = None
        self._preprocessors: tuple[Any, ...] = ()
        self._size = 0

    def answer(self, word: bytes) -> bytes:
        """Do what a request asks for; gives the reply."""
        try:
            if word == channel.ACT:
                return self._act()
            if word == channel.BUILD:
                self._build(self._memory.read_text())
            elif word == channel.EPISODE:
                self._begin_episode(self._memory.read_text())
            elif word == channel.STOP:
                self._agent.stop()
        except BaseException as failure:
            self._memory.write_text(_error_text(failure))
            return channel.RAISED
        return channel.DONE

    def _build(self, job: dict[str, Any]) -> None:
        """Give up every right, then load the agent."""
        Restrictions.from_json(job["restrictions"]).apply()
        from airhockey.evaluator.isolation.build_local import build_from_names

        seed(job["seed"])
        self._agent, self._size = build_from_names(job)
        os.environ["PYTHONPATH"] = os.pathsep.join([os.getcwd(), os.environ.get("PYTHONPATH", "")])  # of its children
        order = self._agent.interpolation_order
        self._memory.write_text({"interpolation_order": order if order is None else int(order)})

    def _begin_episode(self, job: dict[str, Any]) -> None:
        seed(job["seed"])
        self._agent.episode_start()
        self._preprocessors = tuple(self._agent.preprocessors)

    def _act(self) -> bytes:
        observation: Any = self._memory.read_observation(self._size)
        for preprocessor in self._preprocessors:
            observation = preprocessor(observation)
        action = self._agent.act(observation)
        try:
            values = np.asarray(action)
            problem = _problem(action, values)
        except (ValueError, TypeError) as error:
            problem = f"the action is not an array of numbers: {error}"
        if problem is not None:
            self._memory.write_text({"what": problem})
            return channel.BAD_ACTION
        self._memory.write_action(values.astype(np.float64, copy=False))
        return channel.DONE


def _problem(action: Any, values: Any) -> str | None:
    """Why an action cannot even be shown to the evaluator."""
    if values.dtype.kind not in "fiu":
        return f"the action is of type {type(action).__name__} with dtype {values.dtype}; return a float array"
    if values.ndim > channel.MAX_DIMENSIONS or values.size > channel.MAX_ACTION:
        return f"the action has shape {values.shape}"
    return None


def _error_text(failure: BaseException) -> dict[str, str]:
    return {"what": describe(failure).encode("utf-8", "replace").decode()[:1000]}


def seed(words: list[int] | None) -> None:
    """Seed the generators that an agent may draw from without asking."""
    from airhockey.evaluator.play.seeding import seed_generators

    if words is not None:
        seed_generators(np.array(words, dtype=np.uint32))


if __name__ == "__main__":
    main()
