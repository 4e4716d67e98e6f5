"""A report as one self-contained page: nothing is loaded, everything is in the file."""

from __future__ import annotations

import base64
import math
from importlib import metadata
from typing import Any

LIBRARIES = ("restitution", "numpy", "scipy", "pandas", "sympy", "iminuit", "matplotlib")


def render(template: str, **content: Any) -> str:
    """Fill a template of this package; ``versions``, ``svg_image`` and ``equation`` are known to all of them."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from restitution.report.drawing import equation

    environment = Environment(
        loader=PackageLoader("restitution.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    versions = {name: metadata.version(name) for name in LIBRARIES}
    known = {"versions": versions, "svg_image": _svg_image, "equation": lambda latex: _svg_image(equation(latex))}
    return environment.get_template(template).render(**known, **content)


def png_image(png: bytes) -> str:
    """The address of a picture that is in the page itself."""
    return "data:image/png;base64," + base64.b64encode(png).decode()


def _svg_image(svg: str) -> str:
    """The address of an image that is in the page itself; as an image its ids cannot clash with another's."""
    return "data:image/svg+xml;base64," + base64.b64encode(svg.encode()).decode()


def number(value: float, digits: int) -> str:
    """A number with so many decimals; nothing for NaN."""
    return "" if math.isnan(value) else f"{value:.{digits}f}"


def percent(value: float, digits: str = ".1f") -> str:
    """A relative error in per cent, with its sign; nothing for NaN, no sign for what is rounded to nought."""
    if math.isnan(value):
        return ""
    shown = f"{value * 100:+{digits}}\N{NO-BREAK SPACE}%".replace("-", "\N{MINUS SIGN}")
    return shown if any(c in "123456789" for c in shown) else shown[1:]  # no sign of nought
