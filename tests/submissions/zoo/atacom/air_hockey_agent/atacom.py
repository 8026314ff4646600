import numpy as np
from air_hockey_challenge.constraints import ConstraintList, EndEffectorConstraint, JointPositionConstraint
from air_hockey_challenge.framework import AgentBase
from air_hockey_challenge.utils import forward_kinematics, jacobian
from scipy.linalg import null_space


class Tangent(AgentBase):
    """Moves in the tangent space of its constraints, with slack variables."""

    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        self.kept = ConstraintList()
        self.kept.add(EndEffectorConstraint(env_info))
        self.kept.add(JointPositionConstraint(env_info))
        official = env_info["constraints"].get("ee_constr")
        assert [official.x_lb, official.y_ub] == [self.kept.get("ee_constr").x_lb, self.kept.get("ee_constr").y_ub]
        self.middle = np.array([official.x_lb + 0.1, 0.0, 0.5 * (official.z_lb + official.z_ub)])
        self.limit = env_info["constraints"].get("joint_vel_constr").joint_limits[1]

    def reset(self):
        self.q = None

    def draw_action(self, observation):
        if self.q is None:
            self.q = self.get_joint_pos(observation).copy()
        n = self.q.size
        values = self.kept.fun(self.q, np.zeros(n))
        slopes = self.kept.jacobian(self.q, np.zeros(n))
        c = np.concatenate(list(values.values()))
        slope = np.concatenate(list(slopes.values()))[:, :n]
        slack = np.log(np.expm1(np.maximum(-c, 1e-3)))
        full = np.hstack((slope, np.diag(1.0 / (1.0 + np.exp(-slack)))))
        base = null_space(full)
        tip = forward_kinematics(self.robot_model, self.robot_data, self.q)[0]
        pull = jacobian(self.robot_model, self.robot_data, self.q)[:3].T @ (self.middle - tip)
        tangent = base @ (base.T @ np.concatenate((pull, np.zeros(c.size))))
        velocity = np.clip(0.2 * tangent[:n], -0.2 * self.limit, 0.2 * self.limit)
        self.q = self.q + velocity * self.env_info["dt"]
        return np.stack((self.q, velocity))
