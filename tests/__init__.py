"""The tests mirror the packages; what several of them share, as ``tests.fits``, lies beside the folders."""
