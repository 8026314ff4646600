"""What a run leaves on the disk: manifest, folder, journal and trajectories, and how they are read back."""
