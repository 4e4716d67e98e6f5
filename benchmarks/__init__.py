"""Measurements of speed, each a ratio of things timed in the same run."""
