"""What happens when a mallet meets a puck, and where it can."""
