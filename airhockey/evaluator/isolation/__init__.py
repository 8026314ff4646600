"""Agents in processes of their own: what they may use is limited, what they see is theirs, what they break is theirs.

build.py      one function that builds an agent as asked: here, in a process, in a sandbox, or far away
modes.py      none, process, sandbox; which is taken where nobody says
host.py       the evaluator's side: an object with an agent's interface
guest.py      the agent's side: the loop of the child process
channel.py    the memory that both share, and what lies where in it
launch.py     how a child is started: plainly, or under bubblewrap
limits.py     memory, time, files, processes
remote.py     an agent behind a TCP port, in the protocol of the challenge
"""
