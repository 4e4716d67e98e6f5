"""Reference toolkit for wet rebound: closure laws, measured data, impacts, comparison and reports."""

__version__ = "0.1.0"
