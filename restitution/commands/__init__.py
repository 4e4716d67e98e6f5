"""The subcommands, one module each: ``add_parser(subparsers)`` declares it, ``run(args)`` does it.

Modules here import nothing heavy at the top, so that ``restitution --help`` stays quick.
"""
