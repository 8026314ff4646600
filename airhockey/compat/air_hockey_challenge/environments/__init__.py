"""The base environments by their official names."""
