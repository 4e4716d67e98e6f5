"""The report of e asked and delivered: made of the kept table alone, the same bytes each time."""

import re
from pathlib import Path

import numpy as np
import pytest

from restitution.errors import InputError
from restitution.export.drops import Deck, Installed, NotInstalledError, Program
from restitution.export.drops.kept import kept_text, measure, read_kept, steel
from restitution.report.delivered import content, languages, report

KEPT = Path("reports/export/delivered.csv")


def program(title: str, off_by: float, there: bool = True) -> Program:
    """A stand-in that delivers the law, a little off."""

    def find(level: int) -> Installed:
        if not there:
            raise NotInstalledError("it is not there")
        return Installed("1.0", lambda deck: [["cat", deck.main]])

    def deck(impacts, request, speeds) -> Deck:
        e = impacts.restitution(impacts.stokes(speeds)) + off_by
        text = "".join(f"drop {v} {x}\n" for v, x in zip(speeds, e, strict=True))
        return Deck("in.drop", {"in.drop": text})

    return Program(title, deck, lambda impacts, request, St: impacts.restitution(St), find)


def test_kept_rows_are_those_that_the_programs_gave():
    """By hand: 0.97 exp(-35.46/St) at St = rho v d/(9 mu)."""
    table = measure([("a", program("A", 0.003))], None, lambda said: None)
    law = 0.97 * np.exp(-35.46 / (7800 * 0.003 / 0.09 * table["impact_speed"].to_numpy(float)))
    np.testing.assert_allclose(table["e_law"].to_numpy(float), law, rtol=1e-9)
    np.testing.assert_allclose(table["e_delivered"].to_numpy(float), law + 0.003, rtol=1e-6)
    assert sorted(set(table["level"])) == [0, 1, 2]
    assert (table["stokes"].min(), table["stokes"].max()) == pytest.approx((20, 1000))


def test_rows_of_a_program_that_is_not_installed_stay(tmp_path):
    said = []
    before = measure([("a", program("A", 0.003)), ("b", program("B", 0.001))], None, said.append)
    (tmp_path / "kept.csv").write_text(kept_text(before))
    programs = [("a", program("A", 0.009, there=False)), ("b", program("B", 0.002))]
    after = measure(programs, read_kept(tmp_path / "kept.csv"), said.append)
    off = (after["e_delivered"] - after["e_law"]).groupby(after["program"]).max()
    assert off.to_dict() == pytest.approx({"A": 0.003, "B": 0.002}, abs=2e-6)
    assert sum("it is not there" in line for line in said) == 3


def test_the_committed_report_is_made_of_the_committed_table(tmp_path):
    (tmp_path / report.KEPT).write_bytes(KEPT.read_bytes())
    names = report.write(tmp_path)
    first = {name: (tmp_path / name).read_bytes() for name in names}
    assert {name: (tmp_path / name).read_bytes() for name in report.write(tmp_path)} == first
    page = first["index.html"].decode()
    assert not re.search(r'(src|href)="(?!data:)', page)  # it loads nothing
    for _, row in read_kept(KEPT).iterrows():
        assert f"{row['e_delivered']:.4f}" in page


def test_what_is_committed_keeps_the_promise():
    """Within 0.01 of the law at level 2, St 20 to 1000; at every level what the texts promise."""
    table, summary = content.gather(str(KEPT))
    assert {(s.program, s.level) for s in summary} >= {
        (p, level) for p in ("LAMMPS", "LIGGGHTS", "YADE") for level in (0, 1, 2)
    }
    law = 0.97 * np.exp(-18 * 1.97 / table["stokes"])
    np.testing.assert_allclose(table["e_law"], law, atol=2e-6)
    np.testing.assert_allclose(table["stokes"], table["impact_speed"] * steel().per_speed, rtol=1e-5)
    second = table["level"] == 2
    assert (table["e_delivered"] - law)[second].abs().max() < 0.01
    assert (table["e_delivered"] - table["e_asked"]).abs().max() < 0.01


def test_bad_tables_are_named(tmp_path):
    with pytest.raises(InputError, match="--measure"):
        report.write(tmp_path)
    lines = KEPT.read_text().splitlines()
    (tmp_path / report.KEPT).write_text("\n".join([lines[0], lines[1].replace("0.68", "6.8"), *lines[2:]]) + "\n")
    with pytest.raises(InputError, match=r"e_asked|e_delivered"):
        report.write(tmp_path)
    table = read_kept(KEPT)
    table.loc[1, "version"] = "another"
    (tmp_path / report.KEPT).write_text(kept_text(table))
    with pytest.raises(InputError, match="several versions"):
        report.write(tmp_path)


def test_the_command_writes_the_page(tmp_path, capsys):
    from restitution.cli import main

    (tmp_path / report.KEPT).write_bytes(KEPT.read_bytes())
    assert main(["report", "export", "--out", str(tmp_path)]) == 0
    assert str(tmp_path / "index.html") in capsys.readouterr().out
    assert main(["report", "export", "--out", str(tmp_path / "empty")]) == 2
    assert "--measure" in capsys.readouterr().err


def test_languages_on_record_agree_to_the_digits_of_a_double(tmp_path):
    kept = languages.gather(KEPT.parent / report.LANGUAGES)
    assert {a.points for a in kept} == {1000}
    assert max(a.value for a in kept) < 1e-12
    (tmp_path / report.KEPT).write_bytes(KEPT.read_bytes())
    report.write(tmp_path)  # without that table too
    page = (tmp_path / "index.html").read_text()
    assert not any(a.program in page for a in kept)
