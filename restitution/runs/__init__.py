"""Runs of the resolved solver.

A case becomes what the solver is told (``setup``, ``told``); ``physics`` says whether the program still computes
what it did when the kept runs were made.
"""
