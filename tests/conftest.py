"""What holds for all tests: the same examples are tried each time, and nothing is kept of them."""

import signal

from hypothesis import HealthCheck, settings

settings.register_profile(
    "same", derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("same")

# A process that was started in the background may have been told to ignore Ctrl-C, which tests send.
signal.signal(signal.SIGINT, signal.default_int_handler)
