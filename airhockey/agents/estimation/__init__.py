"""Estimation of the puck: its motion, a Kalman filter, prediction."""
