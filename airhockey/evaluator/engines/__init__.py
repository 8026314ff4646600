"""Engines: they map jobs to results, in this process, in many, or on a cluster."""
