"""``restitution predict``."""


def add_parser(commands):
    pass
