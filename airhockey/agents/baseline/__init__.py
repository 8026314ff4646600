"""The planning player `baseline`: it predicts, chooses a skill, plans and tracks."""
