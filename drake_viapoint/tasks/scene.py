"""What every scene begins with: its model files, and a plant that is shown or not."""

from __future__ import annotations

from pathlib import Path

from pydrake.geometry import Meshcat, MeshcatVisualizer, SceneGraph
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    ApplyMultibodyPlantConfig,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.systems.framework import DiagramBuilder

from drake_viapoint.packages import resolve
from drake_viapoint.robot.directives import add_directives


def scene_path(address: str) -> Path:
    """File of a ``package://`` address or of a path."""
    return resolve(address) if address.startswith("package://") else Path(address)


def add_plant(
    builder: DiagramBuilder,
    config: MultibodyPlantConfig,
    meshcat: Meshcat | None = None,
    *,
    touches: bool = False,
) -> MultibodyPlant:
    """An empty plant in a diagram.

    Unless it is shown or touches anything no geometry is registered: the dynamics need none, and
    collision queries would cost more than they do.

    Args:
        builder: Where the plant goes, under the name ``plant``.
        config: Of the plant.
        meshcat: Where to show it, if anywhere.
        touches: Whether its bodies may touch each other.
    """
    if meshcat is None and not touches:
        plant: MultibodyPlant = builder.AddNamedSystem("plant", MultibodyPlant(config.time_step))
        ApplyMultibodyPlantConfig(config, plant)
        return plant
    scene_graph: SceneGraph
    plant, scene_graph = AddMultibodyPlant(config, builder)
    if meshcat is not None:
        MeshcatVisualizer.AddToBuilder(builder, scene_graph, meshcat)
    return plant


def add_models(plant: MultibodyPlant, address: str) -> None:
    """Add what a directives file names.

    Raises:
        ModelFileError: The file or a model it names cannot be read.
    """
    add_directives(plant, scene_path(address), address)
