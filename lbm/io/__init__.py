"""What goes to disk and to the terminal.

Read :mod:`~lbm.io.checkpoint` and :mod:`~lbm.io.vtkhdf` (both write by :mod:`~lbm.io.files`),
:mod:`~lbm.io.progress`, :mod:`~lbm.io.interrupt`.
"""
