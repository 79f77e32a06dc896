"""The serve's scene in Drake: arm, racket, ball and goal, and the control that moves them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pydrake.geometry import Meshcat, MeshcatVisualizer, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import ApplyMultibodyPlantConfig, MultibodyPlant
from pydrake.multibody.tree import QuaternionFloatingJoint, SpatialInertia, UnitInertia
from pydrake.systems.framework import Context, DiagramBuilder

from drake_viapoint.errors import ModelFileError
from drake_viapoint.packages import package_map, resolve
from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.tracking import Tracking
from drake_viapoint.tasks.carried_ball import Cup
from drake_viapoint.tasks.serve_scenario import ServeScenario


def scene_path(address: str) -> Path:
    """File of a ``package://`` address or of a path."""
    return resolve(address) if address.startswith("package://") else Path(address)


class ServeScene:
    """The serve's diagram, built once and used for every trial.

    The ball hangs on a floating joint whose inboard frame is the cup, so it can be locked there and
    load the arm while it is carried. Without a Meshcat no geometry is registered: the ``event``
    execution needs none, and collision queries would cost more than the dynamics.

    Args:
        scenario: Models, ball and control.
        meshcat: Where to show the scene, if anywhere.

    Raises:
        ModelFileError: A model cannot be read, or lacks the arm, a frame or the ball.
    """

    def __init__(self, scenario: ServeScenario, meshcat: Meshcat | None = None) -> None:
        self.arm = Arm(scene_path(scenario.robot.directives), scenario.robot.tool_frame)
        builder = DiagramBuilder()
        self.plant = MultibodyPlant(scenario.plant.time_step)
        ApplyMultibodyPlantConfig(scenario.plant, self.plant)
        scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph()) if meshcat else None
        if scene_graph is not None:
            self.plant.RegisterAsSourceForSceneGraph(scene_graph)
        self._load(scenario)
        builder.AddNamedSystem("plant", self.plant)
        self.tracking = Tracking(
            builder, self.plant, self.instance, self.arm, scenario.robot.natural_frequency
        )
        if scene_graph is not None:
            builder.Connect(
                self.plant.get_geometry_pose_output_port(),
                scene_graph.get_source_pose_port(self.plant.get_source_id()),
            )
            MeshcatVisualizer.AddToBuilder(builder, scene_graph, meshcat)
        self.diagram = builder.Build()
        self.diagram.set_name("serve")

        context = self.plant.CreateDefaultContext()
        racket = self.plant.GetFrameByName(scenario.robot.tool_frame)
        seat = self._cup.CalcPose(context, racket)
        self.cup = Cup(seat.translation(), seat.rotation().matrix()[:, 2])
        ring = self.plant.GetFrameByName(scenario.ring_frame)
        self.ring = ring.CalcPoseInWorld(context).translation()  # (3,) [m]

    def _load(self, scenario: ServeScenario) -> None:
        parser = Parser(self.plant)
        parser.package_map().AddMap(package_map())
        try:
            parser.AddModels(str(scene_path(scenario.scene)))
            self.instance = self.plant.GetModelInstanceByName(scenario.robot.arm)
            self.ball = self.plant.GetBodyByName(scenario.ball.body)
            self._cup = self.plant.GetFrameByName(scenario.robot.cup_frame)
            self.plant.GetFrameByName(scenario.ring_frame)
        except RuntimeError as error:
            raise ModelFileError(scenario.scene, " ".join(str(error).split())) from error
        self.carry = self.plant.AddJoint(
            QuaternionFloatingJoint("carry", self._cup, self.ball.body_frame())
        )
        self.plant.Finalize()
        self._inertia = SpatialInertia(
            scenario.ball.mass,
            np.zeros(3),
            UnitInertia.HollowSphere(scenario.ball.radius),
        )

    def load_ball(self, context: Context) -> None:
        """Put the ball into the cup, held there, its weight on the arm (a plant's context)."""
        self.ball.SetSpatialInertiaInBodyFrame(context, self._inertia)
        self.carry.SetPose(context, RigidTransform())
        self.carry.Lock(context)

    def unload_ball(self, context: Context) -> None:
        """Take the ball's weight off the arm: from here on it flies by itself."""
        self.ball.SetMass(context, 0.0)
