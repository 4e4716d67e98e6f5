"""Whether a kept run still holds: by what it was told, and by what the program computes.

:mod:`~.told` (numbers and words that reach the solver), :mod:`~.physics` (probe cases, ``probes.json``, the
version), :mod:`~.program` (the text, a shortcut), :mod:`~.key` (for checkpoints, which hold bit for bit or not at
all).
"""
