"""A track as one looks at it before anything is computed from it.

Read :mod:`.view` (what there is to see), :mod:`.plot` (the picture), :mod:`.page` (the files).
"""

from restitution.report.look.page import Told, pages
from restitution.report.look.view import View, view_of

__all__ = ["Told", "View", "pages", "view_of"]
