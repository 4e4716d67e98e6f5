"""``restitution bounce``: run a case with the point-particle model."""

from __future__ import annotations

import argparse

from restitution.commands.console import doubt_aside, show, show_doubts


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``bounce CASE``."""
    parser = commands.add_parser(
        "bounce",
        help="predict a case in milliseconds: the same sphere as a point particle, from closures",
        description="Run a case, the same file as for 'simulate', with the point-particle model. Writes "
        "trajectory.csv, velocity.csv and impacts.csv in the schemas of the measured data, and run.json.",
        epilog="Contact mode 'effective' takes e_eff by its law or as measured, the film within contact.edge_d "
        "(0.1 d) being a black box; 'dry' takes e_dry at film.floor under all of Brenner's resistance, whatever "
        "film.form adds to a grid, and under none of it with 'none'; film.tension limits the suction. Soft "
        "contacts are refused. [numerics] is not needed.",
    )
    parser.add_argument(
        "case", metavar="CASE", help="a TOML file, or the name of a shipped case (see 'simulate --list')"
    )
    parser.add_argument("--out", metavar="FOLDER", help="where to write the results (CASE_point_particle)")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int | None:
    """Run a case and say what came out."""
    import sys
    import time

    from restitution.bounce import IntegrationError
    from restitution.cases.reading import read_case
    from restitution.commands.results import folder_for, show_contacts
    from restitution.doubts import of_light_rebound
    from restitution.files import write_folder
    from restitution.locks import sole_writer
    from restitution.runs.point_particle import predict, write
    from restitution.runs.record import POINT_PARTICLE

    case = read_case(args.case)
    doubt_aside(case.conditions, args.case)
    folder = folder_for(args.out, f"{case.name}_point_particle", POINT_PARTICLE)
    began = time.perf_counter()
    try:
        prediction = predict(case, args.case)
    except IntegrationError as error:
        print(f"error: {args.case}: {error}", file=sys.stderr)  # noqa: T201
        return 2
    seconds = time.perf_counter() - began
    write_folder(folder, {})
    with sole_writer(folder):
        folder_for(str(folder), folder.name, POINT_PARTICLE)  # another command may have written there meanwhile
        write(prediction, folder, seconds)
    show_contacts(prediction.contacts, list(prediction.path.apexes() * 1e3))
    show(f"results in {folder}")
    if prediction.path.closures.black_box:
        show_doubts(of_light_rebound(case.conditions, prediction.path.closures.film))
    return None
