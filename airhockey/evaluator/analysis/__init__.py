"""What a recorded game shows: who touched the puck when, and what became of the shots."""
