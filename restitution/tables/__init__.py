"""A table read strictly: nothing is guessed, every defect is named.

Read :mod:`~restitution.tables.schema` (the rules), :mod:`~restitution.tables.csv_text` (the text of a file),
:mod:`~restitution.tables.widths` (how much of it there may be), :mod:`~restitution.tables.reading` (the table),
:mod:`~restitution.tables.columns` (its rules); :mod:`~restitution.tables.writing` puts tables out.
"""

from restitution.tables.reading import check_table, examine_table, read_header, read_table
from restitution.tables.schema import Schema, read_record, read_schema

__all__ = [
    "Schema",
    "check_table",
    "examine_table",
    "read_header",
    "read_record",
    "read_schema",
    "read_table",
]
