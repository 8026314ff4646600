"""The player `planner`: it predicts, chooses a skill, plans and tracks."""
