"""The comparison reports: each gathers tables, draws figures and fills one self-contained page."""
