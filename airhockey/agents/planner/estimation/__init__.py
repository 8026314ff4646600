"""What the planner learns from watching: whether and where a puck rests, the opponent's swing, the fate of its shots."""
