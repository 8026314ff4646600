import numpy as np
from air_hockey_challenge.framework import AgentBase
from scipy import optimize, sparse
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

try:
    import jax.numpy as jnp
except ImportError:
    jnp = np


def build_agent(env_info, **kwargs):
    return Optimizer(env_info, **kwargs)


class Optimizer(AgentBase):
    """A little quadratic programme at every step."""

    def reset(self):
        self.q = None

    def draw_action(self, observation):
        if self.q is None:
            self.q = np.array(self.get_joint_pos(observation))
            self.goal = self.q + 0.01
            Rotation.from_matrix(self.get_ee_pose(observation)[1]).as_euler("xyz")
            self.path = CubicSpline([0.0, 1.0], np.stack((self.q, self.goal)))
        bounds = optimize.Bounds(self.q - 0.002, self.q + 0.002)
        weight = sparse.identity(len(self.q))
        found = optimize.minimize(
            lambda q: float(jnp.sum((weight @ (q - self.goal)) ** 2)), self.q, bounds=bounds, method="L-BFGS-B"
        )
        linear = optimize.linprog(np.ones(2), A_ub=-np.eye(2), b_ub=-np.ones(2))
        assert linear.success
        velocity = (found.x - self.q) / self.env_info["dt"]
        self.q = found.x
        return np.array([self.q, velocity])
