"""The shipped data package: records of experiments, exact tables, and what is known about each.

Read :mod:`~restitution.datasets.package` (what is stated about a record), :mod:`~restitution.datasets.shipped`
(the records that come with this package), :mod:`~restitution.datasets.checks` (defects of a package, a schema for
a table).
"""

from restitution.datasets.checks import check_package, infer_schema
from restitution.datasets.package import Resource, read_package
from restitution.datasets.shipped import folder, load, load_track, names, resource, schema, schema_names

__all__ = [
    "Resource",
    "check_package",
    "folder",
    "infer_schema",
    "load",
    "load_track",
    "names",
    "read_package",
    "resource",
    "schema",
    "schema_names",
]
