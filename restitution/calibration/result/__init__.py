"""What is kept of a fit, and what it is good for.

Read :mod:`.fit_result`, :mod:`.fit_file`, :mod:`.residuals`, :mod:`.influence`, :mod:`.fit_summary` (the fit),
:mod:`.fitted_law`, :mod:`.kept_draws`, :mod:`.bands` and :mod:`.prediction`, :mod:`.chained` (the prior of a later
fit), :mod:`.leaving_out` and :mod:`.ranking`, and :mod:`.design` with :mod:`.release` (what to measure next).
"""
