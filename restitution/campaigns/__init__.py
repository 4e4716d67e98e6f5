"""Campaigns: many runs of one case with keys varied, on as many processes and machines as there are.

Read :mod:`~restitution.campaigns.design` (what is varied, and which runs follow),
:mod:`~restitution.campaigns.plan` (those runs by their content), :mod:`~restitution.campaigns.run` (one of them, a
plain function), :mod:`~restitution.campaigns.manifest` (what is finished), :mod:`~restitution.campaigns.driver`
(from the plan to the manifest, on any ``Executor``), :mod:`~restitution.campaigns.sweep`
(the whole of it), :mod:`~restitution.campaigns.fork` (approaches that runs share),
:mod:`~restitution.campaigns.cluster` (Dask), :mod:`~restitution.campaigns.processes` (the one of this
machine, as :mod:`~restitution.campaigns.share` shares it out), :mod:`~restitution.campaigns.table` (what came
out); :mod:`~restitution.campaigns.progress` looks on, :mod:`~restitution.campaigns.keeping` tidies up.
"""
