"""The report of e asked against e delivered in other programs.

Read :mod:`.report`, then :mod:`.content` and :mod:`.languages`, the kept tables, :mod:`.plot`, :mod:`.page`.
"""
