"""Low-level control: kinematics, anchored quadratic programming, joint commands, trajectories."""
