"""Settings and fixtures shared by all tests."""

import os
import signal

import pytest
from hypothesis import settings

from drake_viapoint.packages import resolve
from drake_viapoint.robot.arm import Arm
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_scenario import ServeScenario

# A busy machine is no failure: what a property may cost is not hypothesis's to judge. New examples
# are for people to find; a gate tries the same ones every time.
settings.register_profile("drake-viapoint", deadline=None)
settings.register_profile("gate", deadline=None, derandomize=True, database=None)
settings.load_profile("gate" if os.environ.get("CI") else "drake-viapoint")


@pytest.fixture(scope="session", autouse=True)
def _ctrl_c() -> None:
    """What a shell starts in the background ignores Ctrl-C, and so would what tests start."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def arm() -> Arm:
    """The serve's arm with the racket in its hand."""
    return Arm(resolve("package://drake_viapoint/arm_with_racket.dmd.yaml"), "racket")


@pytest.fixture(scope="session")
def serve_task() -> ServeTask:
    """The shipped serve, its scene and its demonstration; tests leave it as they found it."""
    return ServeTask(ServeScenario())
