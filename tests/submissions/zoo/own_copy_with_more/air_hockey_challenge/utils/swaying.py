from air_hockey_challenge.utils.kinematics import forward_kinematics as forward_kinematics

WIDTH = 0.04
