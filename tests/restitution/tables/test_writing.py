"""Tables as text: digits, and what is empty."""

import io
import math

import numpy as np
import pandas as pd

from restitution.tables.writing import records_text, rows_text, table_text


def test_records_are_written_as_a_table_of_them_is():
    records = [
        {"law": "a, b", "K": 17.98765, "impacts": 12, "separated": False, "elpd": None},
        {"law": "c", "K": math.nan, "impacts": 3, "separated": True, "elpd": np.float64(1.5)},
    ]
    assert records_text(records, "%.3g") == table_text(pd.DataFrame(records), "%.3g")


def test_what_is_written_is_read_again():
    rows = [("x", 1.23456789, 2), ("y", None, 10**7)]
    table = pd.read_csv(io.StringIO(rows_text(("name", "value", "count"), rows)))
    assert list(table["value"].fillna(-1)) == [1.23457, -1]
    assert list(table["count"]) == [2, 10**7]
