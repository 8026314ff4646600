"""A cubic in task space, tracked by bounded least squares in joint velocities."""

import numpy as np
from air_hockey_challenge.utils.kinematics import forward_kinematics, jacobian
from scipy.optimize import lsq_linear


class TrajectoryOptimizer:
    def __init__(self, env_info, robot_model, robot_data):
        self.env_info = env_info
        self.robot_model = robot_model
        self.robot_data = robot_data
        self.dt = env_info["dt"]
        self.limit = 0.9 * env_info["robot"]["joint_vel_limit"][1]

    def optimize(self, start, end, end_velocity, q, q_end, duration):
        steps = max(int(duration / self.dt), 2)
        commands = []
        for k in range(1, steps + 1):
            wanted = cubic(k / steps, start, end, end_velocity * steps * self.dt)
            reached = forward_kinematics(self.robot_model, self.robot_data, q)[0][:2]
            slope = jacobian(self.robot_model, self.robot_data, q)[:2]
            pull = 0.05 * (q_end - q)
            a = np.vstack((slope, 0.01 * np.eye(q.size)))
            b = np.concatenate(((wanted - reached) / self.dt, 0.01 * pull))
            low, high = self.bounds(q)
            velocity = lsq_linear(a, b, (low, high), method="bvls").x
            q = q + velocity * self.dt
            commands.append(np.stack((q, velocity)))
        rest = [np.stack((q, np.zeros_like(q)))]
        return commands + rest

    def bounds(self, q):
        lower, upper = self.env_info["robot"]["joint_pos_limit"] * 0.95
        return np.maximum(-self.limit, (lower - q) / self.dt) - 1e-9, np.minimum(
            self.limit, (upper - q) / self.dt
        ) + 1e-9


def cubic(s, start, end, end_slope):
    h00, h01, h11 = 2 * s**3 - 3 * s**2 + 1, -2 * s**3 + 3 * s**2, s**3 - s**2
    return h00 * start + h01 * end + h11 * end_slope
