"""The tasks as a learner wants them: actions that cannot break a rule, observations of order one, rewards on the way.

import gymnasium

import airhockey.learning.envs.gymnasium

vec = gymnasium.make_vec("airhockey/7dof-defend-tip-v0", num_envs=16, threads=2)
"""
