"""What neither the controller nor the learner knows, drawn from seeds: of the robot, of a trial."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, SpatialInertia

from drake_viapoint.robot.inertia_draw import draw_inertias
from drake_viapoint.tasks.serve_robot_scenario import ServeUnknown


class TrialDraw(NamedTuple):
    """What one trial is like."""

    mount: NDArray[np.float64]  # (3,) rotation vector of the racket in its mount [rad]
    restitution: float  # factor on the ball's restitution


AVERAGE = TrialDraw(np.zeros(3), 1.0)
"""A trial in which nothing differs."""


class Unknown:
    """The robot of one run, and what its trials are like.

    Args:
        config: How much is unknown.
        plant: With the robot as modelled.
        instances: Models that belong to it.
        seed: Of the run.

    Attributes:
        inertias: Of the robot's bodies.
    """

    def __init__(
        self,
        config: ServeUnknown,
        plant: MultibodyPlant,
        instances: list[ModelInstanceIndex],
        seed: int,
    ) -> None:
        self._config = config
        self.inertias: Mapping[BodyIndex, SpatialInertia] = draw_inertias(
            plant, instances, config.inertia, spawned(seed, 0)
        )

    def draw(self, seed: int) -> TrialDraw:
        """What the trial with this seed is like."""
        rng = spawned(seed, 0)
        mount = self._config.mount * rng.standard_normal(3)
        return TrialDraw(mount, 1.0 + self._config.restitution * float(rng.uniform(-1.0, 1.0)))


def spawned(seed: int, child: int) -> np.random.Generator:
    """A generator of its own for each of the things that are drawn from one seed."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(child,)))
