"""The judge: points, classes, winners and standings from records alone."""
