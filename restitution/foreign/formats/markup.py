"""Tracks in XML: TrackMate's model and its "Export tracks to XML file", Kinovea's analysis (.kva), Icy's tracks.

TrackMate keeps spots by frame and says by edges which belong to one track (TmXmlWriter of fiji/TrackMate); the
shorter export has a list of detections a particle (its ExportTracksToXML). Kinovea keeps ``x;y;t`` of each point,
pixels and time stamps, and beside it what they are in the units of its user (TrackPoint.WriteXml of Kinovea).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from xml.parsers import expat

from restitution.errors import Defect, InputError
from restitution.foreign.formats.spots import Spots
from restitution.foreign.heading import unit_of
from restitution.foreign.layout import Row
from restitution.foreign.programs import ICY, KINOVEA_TEXT, TRACKMATE

_DEEPEST = 50
"""Elements within one another; the files that are read have seven."""


@dataclass
class _Element:
    line: int
    name: str
    attributes: dict[str, str]
    text: str = ""


def is_markup(text: str) -> bool:
    """Whether a text is XML."""
    return text.lstrip().startswith("<")


def spots(text: str, file: str) -> Spots:
    """The tracks in a text; raises :class:`InputError` where it is no XML, or of none of these programs."""
    elements = _elements(text, file)
    readers = {"TrackMate": _model, "Tracks": _tracks, "KinoveaVideoAnalysis": _kinovea, "root": _icy}
    root = elements[0].name
    if root not in readers:
        rule = f"is XML of {root}, no tracks of TrackMate, Kinovea or Icy; export the table as CSV"
        raise InputError(Defect(rule, file=file))
    found = readers[root](elements)
    if not found.rows:
        raise InputError(Defect(f"is XML of {root} without a point of a track", file=file))
    return found


def _elements(text: str, file: str) -> list[_Element]:
    """All elements in the order of their beginnings, with the text that stands in them."""
    found: list[_Element] = []
    open_ones: list[_Element] = []

    def refuse(rule: str) -> InputError:
        return InputError(Defect(rule, file=file, row=parser.CurrentLineNumber))

    def begin(name: str, attributes: dict[str, str]) -> None:
        if len(open_ones) >= _DEEPEST:
            raise refuse("is XML nested deeper than any track")
        found.append(_Element(parser.CurrentLineNumber, name, attributes))
        open_ones.append(found[-1])

    def word(data: str) -> None:
        if open_ones:
            open_ones[-1].text += data

    def declared(*_: object) -> None:
        raise refuse("is XML that declares a document type or entities, as no file of tracks does")

    # A text has no encoding any more, whatever its first line says.
    parser = expat.ParserCreate("utf-8")
    parser.buffer_text = True
    parser.StartElementHandler, parser.CharacterDataHandler = begin, word
    parser.EndElementHandler = lambda _: open_ones.pop() and None
    parser.StartDoctypeDeclHandler = declared
    try:
        parser.Parse(text.lstrip().encode("utf-8"), True)
    except expat.ExpatError as error:
        rule = f"is no whole XML: {expat.ErrorString(error.code)}"
        raise InputError(Defect(rule, file=file, row=error.lineno)) from None
    return found


def _model(elements: Sequence[_Element]) -> Spots:
    """TrackMate's model: spots that an edge of a track joins, of the tracks that its filters left."""
    of_spot: dict[str, str] = {}
    kept: set[str] = set()
    track, names = "", ["TRACK_ID", "POSITION_X", "POSITION_Y", "POSITION_Z", "POSITION_T", "FRAME"]
    for e in elements:
        if e.name == "Track":
            track = e.attributes.get("TRACK_ID", "")
        elif e.name == "Edge":
            for end in ("SPOT_SOURCE_ID", "SPOT_TARGET_ID"):
                of_spot.setdefault(e.attributes.get(end, ""), track)
        elif e.name == "TrackID":
            kept.add(e.attributes.get("TRACK_ID", ""))
    rows = []
    for e in elements:
        own = of_spot.get(e.attributes.get("ID", "")) if e.name == "Spot" else None
        if own is not None and (not kept or own in kept):
            rows.append(Row(e.line, [own, *(e.attributes.get(name, "") for name in names[1:])]))
    model = next((e.attributes for e in elements if e.name == "Model"), {})
    return Spots(names, rows, TRACKMATE, _stated(model.get("spatialunits"), model.get("timeunits")))


def _tracks(elements: Sequence[_Element]) -> Spots:
    """TrackMate's export of tracks: t counts frames, of ``frameInterval``."""
    about = elements[0].attributes
    units = _stated(about.get("spaceUnits"), about.get("timeUnits"))
    timed = units.get("POSITION_T", "frame") != "frame"
    rows, particle = [], -1
    for e in elements:
        if e.name == "particle":
            particle += 1
        elif e.name == "detection":
            t, *place = (e.attributes.get(name, "") for name in ("t", "x", "y", "z"))
            rows.append(Row(e.line, [f"{particle}", *place, _times(t, about.get("frameInterval")), t]))
    names = ["TRACK_ID", "POSITION_X", "POSITION_Y", "POSITION_Z", "POSITION_T", "FRAME"]
    return Spots(names, rows, TRACKMATE, units if timed else units | {"POSITION_T": "frame"})


def _icy(elements: Sequence[_Element]) -> Spots:
    """Icy's tracks: t counts frames, places are in pixels."""
    rows, track = [], ""
    for e in elements:
        if e.name == "track":
            track = e.attributes.get("id", "")
        elif e.name == "detection" and track:
            rows.append(Row(e.line, [track, *(e.attributes.get(name, "") for name in "txyz")]))
    return Spots(["track", "t", "x", "y", "z"], rows, ICY)


def _times(count: str, interval: str | None) -> str:
    try:
        return f"{float(count) * float(interval or ''):.12g}"
    except ValueError:
        return count


def _stated(length: str | None, time: str | None) -> dict[str, str]:
    units = dict.fromkeys(("POSITION_X", "POSITION_Y", "POSITION_Z"), unit_of(length)) if length else {}
    return units | ({"POSITION_T": unit_of(time)} if time else {})


def _kinovea(elements: Sequence[_Element]) -> Spots:
    """Kinovea's points: in the units of its user where they are calibrated, else in pixels, counted down."""
    stated = {e.name: e.text.strip() for e in elements if not e.attributes}
    a_frame, rate = (_number(stated.get(name)) for name in ("AverageTimeStampsPerFrame", "CaptureFramerate"))
    rows, names, unit, track, count = [], set[str](), "px", "", 0
    points = []
    for e in elements:
        if e.name == "Track":
            count += 1
            track = e.attributes.get("name") or f"{count}"
            track = f"{track} ({count})" if track in names else track
            names.add(track)
        elif e.name == "TrackPointList":
            unit = e.attributes.get("UserUnitLength") or "px"
        elif e.name == "TrackPoint":
            points.append((e, track))
    calibrated = unit_of(unit) != "px" and all("UserY" in e.attributes for e, _ in points)
    begin = min((_number(e.text.split(";")[-1]) or 0.0 for e, _ in points), default=0.0)
    for e, own in points:
        *pixels, stamp = e.text.strip().split(";")
        given = (e.attributes.get(f"{n}Invariant") or e.attributes.get(n, "") for n in ("UserX", "UserY"))
        user = [text.replace(",", ".") for text in given]  # of its user's language
        x, y = user if calibrated else [*pixels, "", ""][:2]
        frame = ((_number(stamp) or 0.0) - begin) / (a_frame or 1.0)
        rows.append(Row(e.line, [own, f"{frame / rate:.10g}" if rate else f"{frame:.10g}", x, y]))
    clock = "s" if rate else "frame"
    program = replace(
        KINOVEA_TEXT, units={"t": clock, "x": "px", "y": "px"}, down=not calibrated, either_way=False
    )
    units = {"T": clock} | (dict.fromkeys("XY", unit_of(unit)) if calibrated else {})
    return Spots(["trajectory", "T", "X", "Y"], rows, program, units)


def _number(text: str | None) -> float | None:
    plain = (text or "").strip().replace(",", ".")
    return float(plain) if re.fullmatch(r"-?\d+(\.\d*)?", plain) else None
