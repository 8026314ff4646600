"""Recorded runs and games in the formats of others: data sets for learners, tables, joint trajectories."""
