"""The agent's side in an interpreter of its own: Python 3.8 to 3.14, with NumPy and nothing else that we need.

    PATH -I foreign_process.py REQUESTS REPLIES MEMORY      (file descriptors)

It speaks the protocol of `channel.py` and does what `agent_process.py` does, in one file that imports nothing of airhockey. What
the agent is told comes as data. `air_hockey_challenge` is the interpreter's own or the submission's; where there is neither, a
stand-in of AgentBase, constraints and kinematics is there. `robot_model` is there where the interpreter has MuJoCo.
"""

import ctypes
import importlib
import importlib.util
import json
import math
import mmap
import os
import random
import resource
import signal
import struct
import sys
import traceback
import types

import numpy as np

BUILD, EPISODE, ACT, STOP = b"B", b"E", b"A", b"S"
HELLO, DONE, RAISED, BAD_ACTION = b"H", b"K", b"X", b"N"
MESSAGE = 9  # a word and a nonce, which the reply repeats
OBSERVATION, ACTION, TEXT, SIZE = 64, 4096, 65536, 131072
MAX_DIMENSIONS = 4
MAX_ACTION = (TEXT - ACTION) // 8
PACKAGE = "air_hockey_agent"
CHALLENGE = "air_hockey_challenge"


def main():
    """Serve until the evaluator hangs up."""
    requests, replies, descriptor = (int(argument) for argument in sys.argv[1:4])
    del sys.argv[1:]  # an agent that reads the command line is not to find ours
    memory = Memory(descriptor)
    os.close(descriptor)
    for pipe in (requests, replies):
        os.set_inheritable(pipe, False)
    server = Server(memory)
    os.write(replies, HELLO)
    while True:
        message = os.read(requests, MESSAGE)
        if not message:
            break
        word, nonce = message[:1], message[1:]
        os.write(replies, server.answer(word) + nonce)
        if word == STOP:
            break
    os._exit(0)


class Memory:
    """What evaluator and agent share; see `channel.py`."""

    def __init__(self, descriptor):
        self._map = mmap.mmap(descriptor, SIZE)
        self._header = np.frombuffer(self._map, np.int64, 2 + MAX_DIMENSIONS)
        self._observation = np.frombuffer(self._map, np.float64, (ACTION - OBSERVATION) // 8, OBSERVATION)
        self._action = np.frombuffer(self._map, np.float64, MAX_ACTION, ACTION)

    def read_observation(self, size):
        """A copy of the observation. Shape (size,)."""
        return self._observation[:size].copy()

    def write_action(self, action):
        """Put an action where the evaluator reads it."""
        self._header[1] = action.ndim
        self._header[2 : 2 + action.ndim] = action.shape
        self._action[: action.size] = action.reshape(-1)

    def write_text(self, content):
        """Put something that JSON knows where the evaluator reads it."""
        text = json.dumps(content).encode()
        self._map[TEXT : TEXT + len(text)] = text
        self._header[0] = len(text)

    def read_text(self):
        """What the evaluator put there."""
        return json.loads(self._map[TEXT : TEXT + int(self._header[0])])


class Server:
    """Answers the evaluator's requests."""

    def __init__(self, memory):
        self._memory = memory
        self._agent = None
        self._preprocessors = ()
        self._size = 0

    def answer(self, word):
        """Do what a request asks for; gives the reply."""
        try:
            if word == ACT:
                return self._act()
            if word == BUILD:
                self._build(self._memory.read_text())
            elif word == EPISODE:
                seed(self._memory.read_text()["seed"])
                self._agent.episode_start()
                self._preprocessors = tuple(getattr(self._agent, "preprocessors", ()))
            elif word == STOP:
                getattr(self._agent, "stop", lambda: None)()
        except BaseException as failure:
            self._memory.write_text({"what": described(failure)})
            return RAISED
        return DONE

    def _build(self, job):
        restrict(job["restrictions"])
        seed(job["seed"])
        self._size = job["size"]
        self._agent = build(job)
        order = job["named_order"] if job["named_order"] != "agent" else getattr(self._agent, "interpolation_order", 3)
        self._memory.write_text({"interpolation_order": None if order in (None, "none") else int(order)})

    def _act(self):
        observation = self._memory.read_observation(self._size)
        for preprocessor in self._preprocessors:
            observation = preprocessor(observation)
        action = self._agent.draw_action(observation)
        try:
            values = np.asarray(action)
            problem = None
            if values.dtype.kind not in "fiu":
                problem = "the action has dtype {}; return a float array".format(values.dtype)
            elif values.ndim > MAX_DIMENSIONS or values.size > MAX_ACTION:
                problem = "the action has shape {}".format(values.shape)
        except (ValueError, TypeError) as error:
            problem = "the action is not an array of numbers: {}".format(error)
        if problem is not None:
            self._memory.write_text({"what": problem})
            return BAD_ACTION
        self._memory.write_action(values.astype(np.float64))
        return DONE


def described(failure):
    """One line: what it is, what it says, where."""
    try:
        text = " ".join(str(failure).split())[:220]
        frames = traceback.extract_tb(failure.__traceback__)
        place = " ({}:{})".format(os.path.basename(frames[-1].filename), frames[-1].lineno) if frames else ""
    except BaseException:
        text, place = "", ""
    what = "{}: {}{} (Python {}.{}, NumPy {})".format(
        type(failure).__name__, text, place, sys.version_info[0], sys.version_info[1], np.__version__
    )
    return what.encode("utf-8", "replace").decode()[:1000]


def seed(words):
    """Seed the generators that an agent may draw from without asking."""
    if words is None:
        return
    np.random.seed(np.array(words, dtype=np.uint32))
    random.seed(words[0])
    torch = sys.modules.get("torch")
    if torch is not None:
        torch.manual_seed(words[0])


def restrict(job):
    """Die with the evaluator, be the first to go when memory runs out, keep to the limits, be nobody; see `restrict.py`."""
    libc = ctypes.CDLL(None, use_errno=True)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with open("/proc/self/oom_score_adj", "w") as score:
            score.write("1000")
    except OSError:
        pass
    limits = job["limits"]
    kinds = {"memory": "AS", "cpu": "CPU", "file": "FSIZE", "open_files": "NOFILE"}
    if job["sandbox"]:
        kinds["processes"] = "NPROC"
    for name, kind in kinds.items():
        number = getattr(resource, "RLIMIT_" + kind)
        hard = resource.getrlimit(number)[1]
        bound = limits[name] if hard == resource.RLIM_INFINITY else min(limits[name], hard)
        resource.setrlimit(number, (bound, bound))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    user = job["user"]
    if user is not None:
        os.setgroups([])
        os.setresgid(user, user, user)
        os.setresuid(user, user, user)
    if job["sandbox"]:
        filter_system_calls(libc, job["kernel"])
    else:
        libc.prctl(36, 1, 0, 0, 0)
    if user is not None:
        libc.prctl(4, 1, 0, 0, 0)
    libc.prctl(1, int(signal.SIGKILL), 0, 0, 0)


def filter_system_calls(libc, kernel):
    """Drop every capability, leave the session's keyring, and put the evaluator's filter on this process for good."""
    libc.syscall.restype = ctypes.c_long
    libc.prctl(47, 4, 0, 0, 0)
    header, none = (ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)()
    if libc.syscall(ctypes.c_long(kernel["capset"]), header, none) != 0:
        raise OSError("capabilities cannot be dropped")
    libc.syscall(ctypes.c_long(kernel["keyctl"]), ctypes.c_long(1), None)
    libc.prctl(38, 1, 0, 0, 0)
    raw = bytes.fromhex(kernel["program"])
    buffer = ctypes.create_string_buffer(raw, len(raw))
    described_program = struct.pack("@HP", len(raw) // 8, ctypes.addressof(buffer))
    if libc.syscall(ctypes.c_long(kernel["seccomp"]), ctypes.c_long(1), ctypes.c_long(1), described_program) != 0:
        raise OSError("the kernel takes no filter of system calls")


def build(job):
    """Import the submission's builder and call it."""
    root, package = job["root"], job["package"]
    sys.path[:0] = job["import_path"]
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in (root, os.environ.get("PYTHONPATH")) if path)
    if importlib.util.find_spec(CHALLENGE) is None:
        stand_in(job)
    if os.path.basename(package) != PACKAGE or root == package:
        alias = types.ModuleType(PACKAGE)
        alias.__path__ = [package]
        sys.modules[PACKAGE] = alias
    builder = importlib.import_module(PACKAGE + ".agent_builder").build_agent
    env_info = env_info_of(job)
    names = builder.__code__.co_varnames[: builder.__code__.co_argcount] if hasattr(builder, "__code__") else ()
    arguments = dict(job["arguments"])
    if "agent_id" in names:
        arguments["agent_id"] = job["agent_id"]
    return builder(env_info, **arguments)


def env_info_of(job):
    """What agents are told: data, with constraints, spaces and, where MuJoCo is there, the robot's model."""
    info = dict(job["env_info"])
    robot = {key: np.array(value) if key.endswith("_limit") else value for key, value in info["robot"].items()}
    robot["base_frame"] = [np.array(frame) for frame in robot["base_frame"]]
    robot["robot_model"] = robot["robot_data"] = None
    if importlib.util.find_spec("mujoco") is not None:
        mujoco = importlib.import_module("mujoco")
        robot["robot_model"] = mujoco.MjModel.from_xml_string(job["robot_xml"])
        robot["robot_data"] = mujoco.MjData(robot["robot_model"])
    info["robot"] = robot
    spaces = [Box(np.array(low), np.array(high)) for low, high in (info["rl_info"]["seen"], info["rl_info"]["done"])]
    info["rl_info"] = RLInfo(*(spaces + [info["rl_info"][key] for key in ("gamma", "horizon", "dt")]))
    if "mushroom_rl.core" in sys.modules:
        core, spaces_module = sys.modules["mushroom_rl.core"], importlib.import_module("mushroom_rl.utils.spaces")
        boxes = [spaces_module.Box(space.low, space.high) for space in spaces]
        old = info["rl_info"]
        info["rl_info"] = core.MDPInfo(boxes[0], boxes[1], old.gamma, old.horizon, old.dt)
    info["constraints"] = challenge_constraints(info, Chain(job["chain"]))
    return info


class Box:
    """An interval of arrays."""

    def __init__(self, low, high):
        self.low, self.high, self.shape = low, high, low.shape


class RLInfo:
    """Spaces, discount and horizon."""

    def __init__(self, observation_space, action_space, gamma, horizon, dt):
        self.observation_space, self.action_space = observation_space, action_space
        self.gamma, self.horizon, self.dt = gamma, horizon, dt

    @property
    def shape(self):
        """Shape of an observation, then that of an action."""
        return self.observation_space.shape + self.action_space.shape

    def copy(self):
        """A copy that shares nothing."""
        boxes = [Box(box.low.copy(), box.high.copy()) for box in (self.observation_space, self.action_space)]
        return RLInfo(boxes[0], boxes[1], self.gamma, self.horizon, self.dt)


class Chain:
    """Kinematics of links that turn about their own z axes."""

    def __init__(self, data):
        self.offset, self.rotation, self.tip = (np.array(data[key]) for key in ("offset", "rotation", "tip"))

    def frames(self, q):
        """Origins and rotations of all links and, at the end, of the rod's tip."""
        origin, turn, origins, turns = np.zeros(3), np.eye(3), [], []
        for angle, offset, rotation in zip(np.asarray(q, dtype=float).reshape(-1), self.offset, self.rotation):
            origin = origin + turn @ offset
            c, s = math.cos(angle), math.sin(angle)
            turn = turn @ rotation @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            origins.append(origin)
            turns.append(turn)
        return origins + [origin + turn @ self.tip], turns + [turn]

    def pose(self, q, link="ee"):
        """Position and rotation of a link, "1" … or "ee"."""
        origins, turns = self.frames(q)
        index = len(origins) - 1 if link == "ee" else int(link) - 1
        return origins[index], turns[index]

    def jacobian(self, q, link="ee"):
        """Jacobian of position (rows 0-2) and orientation (rows 3-5). Shape (6, n)."""
        origins, turns = self.frames(q)
        n = len(self.offset)
        index = n if link == "ee" else int(link) - 1
        result = np.zeros((6, n))
        for joint in range(min(index, n - 1) + 1):
            axis = turns[joint][:, 2]
            result[:3, joint] = np.cross(axis, origins[index] - origins[joint])
            result[3:, joint] = axis
        return result


class Constraint:
    """A constraint of the challenge, violated where positive."""

    def __init__(self, name, output_dim, fun, jacobian, **attributes):
        self.name, self.output_dim, self.fun, self.jacobian = name, output_dim, fun, jacobian
        self.__dict__.update(attributes)


class ConstraintList:
    """Constraints by name."""

    def __init__(self):
        self.constraints = {}

    def keys(self):
        """The names."""
        return self.constraints.keys()

    def get(self, key):
        """One of them, or None."""
        return self.constraints.get(key)

    def add(self, constraint):
        """Add one under its name."""
        self.constraints[constraint.name] = constraint

    def delete(self, name):
        """Remove one."""
        del self.constraints[name]

    def fun(self, q, dq):
        """All values."""
        return {name: constraint.fun(q, dq) for name, constraint in self.constraints.items()}

    def jacobian(self, q, dq):
        """All Jacobians."""
        return {name: constraint.jacobian(q, dq) for name, constraint in self.constraints.items()}


def challenge_constraints(info, chain):
    """All constraints of the challenge for a robot."""
    robot, table, margin = info["robot"], info["table"], info["mallet"]["radius"]
    n, result = robot["n_joints"], ConstraintList()
    both = np.vstack((np.eye(n), -np.eye(n)))

    def of_joints(name, limit, velocity):
        limits = 0.95 * limit
        slope = np.hstack((0.0 * both, both) if velocity else (both, 0.0 * both))

        def fun(q, dq):
            values = np.asarray(dq if velocity else q, dtype=float).reshape(-1)
            return np.concatenate((values - limits[1], limits[0] - values))

        result.add(Constraint(name, 2 * n, fun, lambda q, dq: slope.copy(), joint_limits=limits))

    of_joints("joint_pos_constr", robot["joint_pos_limit"], False)
    of_joints("joint_vel_constr", robot["joint_vel_limit"], True)
    x_lb = -robot["base_frame"][0][0, 3] - (table["length"] / 2 - margin)
    y_ub = table["width"] / 2 - margin
    z_lb, z_ub = robot["ee_desired_height"] - 0.02, robot["ee_desired_height"] + 0.02

    def ee(q, dq):
        x, y, z = chain.pose(q)[0]
        return np.array([x_lb - x, -y_ub - y, y - y_ub, z_lb - z, z - z_ub])

    def ee_slope(q, dq):
        x, y, z = chain.jacobian(q)[:3]
        return np.hstack((np.stack((-x, -y, y, -z, z)), np.zeros((5, n))))

    bounds = {"x_lb": x_lb, "y_lb": -y_ub, "y_ub": y_ub, "z_lb": z_lb, "z_ub": z_ub}
    models = {"robot_model": robot["robot_model"], "robot_data": robot["robot_data"]}
    result.add(Constraint("ee_constr", 5, ee, ee_slope, **dict(bounds, **models)))
    if n == 7:

        def links(q, dq):
            return np.array([0.25 - chain.pose(q, link)[0][2] for link in ("7", "4")])

        def links_slope(q, dq):
            return np.hstack((np.stack([-chain.jacobian(q, link)[2] for link in ("7", "4")]), np.zeros((2, n))))

        result.add(Constraint("link_constr", 2, links, links_slope, z_lb=0.25, **models))
    return result


def stand_in(job):
    """The parts of `air_hockey_challenge` that agents use, without MuJoCo and MushroomRL."""
    chain = Chain(job["chain"])

    class AgentBase:
        """What agents derive from."""

        next_action = None

        def __init__(self, env_info, agent_id=1, **kwargs):
            self.env_info, self.agent_id = env_info, agent_id
            self.robot_model, self.robot_data = env_info["robot"]["robot_model"], env_info["robot"]["robot_data"]
            self.mdp_info, self._preprocessors = env_info["rl_info"], []

        @property
        def preprocessors(self):
            return self._preprocessors

        def add_preprocessor(self, preprocessor):
            self._preprocessors.append(preprocessor)

        def episode_start(self):
            self.reset()

        def get_puck_state(self, obs):
            return self.get_puck_pos(obs), self.get_puck_vel(obs)

        def get_joint_state(self, obs):
            return self.get_joint_pos(obs), self.get_joint_vel(obs)

        def get_puck_pos(self, obs):
            return obs[self.env_info["puck_pos_ids"]]

        def get_puck_vel(self, obs):
            return obs[self.env_info["puck_vel_ids"]]

        def get_joint_pos(self, obs):
            return obs[self.env_info["joint_pos_ids"]]

        def get_joint_vel(self, obs):
            return obs[self.env_info["joint_vel_ids"]]

        def get_ee_pose(self, obs):
            return chain.pose(self.get_joint_pos(obs))

    def forward_kinematics(mj_model, mj_data, q, link="ee"):
        return chain.pose(q, link)

    def jacobian(mj_model, mj_data, q, link="ee"):
        return chain.jacobian(q, link)

    limits = np.array(job["env_info"]["robot"]["joint_pos_limit"])

    def inverse_kinematics(mj_model, mj_data, desired_position, desired_rotation=None, initial_q=None, link="ee"):
        """By damped least squares; the rotation, if there is one, is a matrix."""
        target = np.asarray(desired_position, dtype=float)
        q = np.zeros(limits.shape[1]) if initial_q is None else np.array(initial_q, dtype=float)
        for _ in range(1000):
            position, turn = chain.pose(q, link)
            error, slope = target - position[: target.size], chain.jacobian(q, link)
            rows = slope[: target.size]
            if desired_rotation is not None:
                wrong = np.asarray(desired_rotation) @ turn.T
                axis = 0.5 * np.array([wrong[2, 1] - wrong[1, 2], wrong[0, 2] - wrong[2, 0], wrong[1, 0] - wrong[0, 1]])
                error, rows = np.concatenate((error, axis)), np.vstack((rows, slope[3:]))
            if np.linalg.norm(error) < 1e-4:
                return True, q
            step = np.linalg.solve(rows.T @ rows + 1e-3 * np.eye(q.size), rows.T @ error)
            step *= min(1.0, 0.1 / max(np.linalg.norm(step), 1e-12))
            q = np.clip(q + step, 0.95 * limits[0], 0.95 * limits[1])
        return False, q

    def robot_to_world(base_frame, translation, rotation=None):
        return moved(np.asarray(base_frame), translation, rotation)

    def world_to_robot(base_frame, translation, rotation=None):
        return moved(np.linalg.inv(np.asarray(base_frame)), translation, rotation)

    kinematics = dict(forward_kinematics=forward_kinematics, jacobian=jacobian, inverse_kinematics=inverse_kinematics)
    frames = dict(robot_to_world=robot_to_world, world_to_robot=world_to_robot)
    constraints = dict(ConstraintList=ConstraintList, Constraint=Constraint)
    for name, names in (
        ("", {}),
        (".framework", {"AgentBase": AgentBase}),
        (".framework.agent_base", {"AgentBase": AgentBase}),
        (".utils", dict(kinematics, **frames)),
        (".utils.kinematics", kinematics),
        (".utils.transformations", frames),
        (".constraints", constraints),
        (".constraints.constraints", constraints),
    ):
        module = types.ModuleType(CHALLENGE + name)
        module.__path__ = []
        module.__dict__.update(names)
        sys.modules[CHALLENGE + name] = module


def moved(frame, translation, rotation):
    """A pose in another frame: position and rotation matrix."""
    pose, position = np.eye(4), np.asarray(translation, dtype=float)
    pose[: position.size, 3] = position
    if rotation is not None:
        pose[:3, :3] = np.asarray(rotation, dtype=float).reshape(3, 3)
    pose = frame @ pose
    return pose[:3, 3], pose[:3, :3]


if __name__ == "__main__":
    main()
