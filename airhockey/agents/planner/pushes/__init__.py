"""Pushes: short touches of a puck at rest, and the search for the best one."""
