"""Settings shared by all tests."""

from hypothesis import settings

# A busy machine is no failure: what a property may cost is not hypothesis's to judge.
settings.register_profile("drake-viapoint", deadline=None)
settings.load_profile("drake-viapoint")
