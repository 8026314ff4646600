"""Agents in processes of their own: what they may use is limited, what they see is theirs, what they break is theirs.

build.py           one function that builds an agent as asked: here, in a process, in a sandbox, or far away
modes.py           none, process, sandbox; which is taken where nobody says
handle.py          what an agent can be asked, wherever it lives; one in this process
agent_client.py    the evaluator's side of an agent in another process
agent_process.py   the agent's side: the loop of the child process
build_local.py     how an agent is made in the process that it lives in
channel.py         the memory that both share, and what lies where in it
launch.py          how a child is started: plainly, or under bubblewrap
limits.py          memory, time, files, processes
remote.py          an agent behind a TCP port, in the protocol of the challenge; serving.py is its other side
failures.py        what an agent can do wrong, and how it is said
"""
