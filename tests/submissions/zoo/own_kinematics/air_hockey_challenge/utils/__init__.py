from .kinematics import *
