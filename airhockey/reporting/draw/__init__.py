"""Drawings as inline SVG: axes, distributions, the table seen from above, the course of a game."""
