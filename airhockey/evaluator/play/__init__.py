"""Playing: an agent under care, the loop that it plays in, episodes of tasks and games of two."""
