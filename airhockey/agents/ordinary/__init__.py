"""`ordinary`: an opponent in the style of the official baseline of 2023, written from its description."""
