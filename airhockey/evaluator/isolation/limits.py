"""What a process that runs an agent may use."""

import resource
from dataclasses import dataclass

GIB, MIB = 1 << 30, 1 << 20


@dataclass(frozen=True)
class Limits:
    """Upper bounds for one agent.

    Attributes:
        memory: Address space of each process, and what all of them hold together, in bytes. PyTorch alone maps one and a half
            GiB.
        cpu: CPU time of each process, in [s]; no evaluation takes as long.
        file: Size of a file, in bytes.
        scratch: All files in the private scratch folder of a sandbox, in bytes.
        processes: Processes and threads together; counted in the sandbox only.
        cores: CPU cores that its processes may keep busy together; where there is a cgroup.
        open_files: Open files of each process.
        start: Time to import and build the agent, in [s].
        patience: Time for any other answer, in [s], until the agent is stopped.
        step, episode: Time on average for a command and for the start of an episode, in [s], beyond which the agent is stopped
            once it has used up `patience` besides.
    """

    memory: int = 4 * GIB
    cpu: int = 12 * 3600
    file: int = 32 * MIB
    scratch: int = 256 * MIB
    processes: int = 64
    cores: float = 4.0
    open_files: int = 256
    start: float = 300.0
    patience: float = 60.0
    step: float = 0.2
    episode: float = 5.0

    def apply(self, count_processes: bool) -> None:
        """Limit this process and its children.

        Args:
            count_processes: Also limit their number. Only where nobody else's count with them: outside a sandbox they are
                all processes of the user.
        """
        bounds = [
            (resource.RLIMIT_AS, self.memory),
            (resource.RLIMIT_CPU, self.cpu),
            (resource.RLIMIT_FSIZE, self.file),
            (resource.RLIMIT_NOFILE, self.open_files),
            (resource.RLIMIT_CORE, 0),
        ]
        if count_processes:
            bounds.append((resource.RLIMIT_NPROC, self.processes))
        for kind, bound in bounds:
            hard = resource.getrlimit(kind)[1]
            bound = bound if hard == resource.RLIM_INFINITY else min(bound, hard)
            resource.setrlimit(kind, (bound, bound))
