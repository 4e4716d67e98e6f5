"""The report of e asked against e delivered in other programs.

Read :mod:`.report`, then :mod:`.content`, :mod:`.plot`, :mod:`.page`.
"""
