"""Motions of the mallet: towards a place, round the puck, through it."""
