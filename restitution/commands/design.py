"""``restitution design``."""


def add_parser(commands):
    pass
