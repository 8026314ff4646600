"""Shots at the opponent's goal: what is known, how a puck is struck and flies, what a shot is worth, the search."""
