"""``restitution compare``."""


def add_parser(commands):
    pass
