"""The serve's scene in Drake: arm, racket, ball and goal, and the control that moves them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat
from pydrake.math import RigidTransform
from pydrake.multibody.tree import Frame, QuaternionFloatingJoint, SpatialInertia, UnitInertia
from pydrake.systems.framework import Context, DiagramBuilder

from drake_viapoint.errors import ModelFileError
from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.tracking import Tracking
from drake_viapoint.tasks.carried_ball import Cup
from drake_viapoint.tasks.same_arm import ArmSources, require_same_arm, require_same_joints
from drake_viapoint.tasks.scene import add_models, add_plant
from drake_viapoint.tasks.scene import scene_path as scene_path
from drake_viapoint.tasks.serve_scenario import ServeScenario


class ServeScene:
    """The serve's diagram, built once and used for every trial.

    The ball hangs on a floating joint whose inboard frame is the cup, so it can be locked there and
    load the arm while it is carried.

    Args:
        scenario: Models, ball and control.
        meshcat: Where to show the scene, if anywhere.

    Attributes:
        arm: The controller's model of the arm.
        plant: What moves.
        instance: The arm in the plant.
        ball: The ball's body.
        racket_frame: Of the racket: the centre of its face.
        cup_frame: Of the resting ball.
        cup_pose: Pose of the cup's frame in the racket's.
        cup: The same as event execution needs it.
        ring_frame: Of the goal's ring.
        ring: (3,) its centre [m].
        tracking: What makes the arm follow a movement.
        diagram: All of it.

    Raises:
        ModelFileError: A model cannot be read, or lacks the arm, a frame or the ball.
        ScenarioError: The arm of ``robot.directives`` is not the one of ``scene``.
    """

    touches = False
    """Whether bodies may touch each other."""

    def __init__(self, scenario: ServeScenario, meshcat: Meshcat | None = None) -> None:
        self.arm = Arm(scene_path(scenario.robot.directives), scenario.robot.tool_frame)
        builder = DiagramBuilder()
        self.plant = add_plant(builder, scenario.plant, meshcat, touches=self.touches)
        add_models(self.plant, scenario.scene)
        try:
            self.instance = self.plant.GetModelInstanceByName(scenario.robot.arm)
            require_same_joints(self.arm, self.plant, self.instance, ArmSources())
            self.ball = self.plant.GetBodyByName(scenario.ball.body)
            self.cup_frame = self.plant.GetFrameByName(scenario.robot.cup_frame)
            self.racket_frame = self.plant.GetFrameByName(scenario.robot.tool_frame)
            self.ring_frame = self.plant.GetFrameByName(scenario.ring_frame)
        except RuntimeError as error:
            reason = " ".join(str(error).partition(" (valid names")[0].split())
            raise ModelFileError(scenario.scene, reason) from error
        self._carry = self.plant.AddJoint(
            QuaternionFloatingJoint("carry", self._ball_inboard(), self.ball.body_frame())
        )
        self._inertia = SpatialInertia(
            scenario.ball.mass,
            np.zeros(3),
            UnitInertia.HollowSphere(scenario.ball.radius),
        )
        self._before_finalizing(scenario)
        self.plant.Finalize()
        tool = scenario.robot.tool_frame
        require_same_arm(self.arm, self.plant, self.instance, tool, ArmSources())
        self.tracking = Tracking(
            builder, self.plant, self.instance, self.arm, scenario.robot.natural_frequency
        )
        self._after_finalizing(scenario, builder)
        self.diagram = builder.Build()
        self.diagram.set_name("serve")

        context = self.plant.CreateDefaultContext()
        self.cup_pose = self.cup_frame.CalcPose(context, self.racket_frame)
        self.cup = Cup(self.cup_pose.translation(), self.cup_pose.rotation().matrix()[:, 2])
        self.ring = self.ring_frame.CalcPoseInWorld(context).translation()  # (3,) [m]

    def load_ball(self, context: Context) -> None:
        """Put the ball into the cup, held there, its weight on the arm (a plant's context)."""
        self.ball.SetSpatialInertiaInBodyFrame(context, self._inertia)
        self._carry.SetPose(context, RigidTransform())
        self._carry.Lock(context)

    def unload_ball(self, context: Context) -> None:
        """Take the ball's weight off the arm: from here on it flies by itself."""
        self.ball.SetMass(context, 0.0)

    def place_ball(self, context: Context, position: NDArray[np.float64]) -> None:
        """Put the ball somewhere (3,) [m], whatever carries it there (a plant's context)."""
        inboard = self._carry.frame_on_parent().CalcPoseInWorld(context)
        self._carry.SetPose(context, inboard.inverse() @ RigidTransform(position))

    def _ball_inboard(self) -> Frame:
        """What the ball's floating joint floats from."""
        return self.cup_frame

    def _before_finalizing(self, scenario: ServeScenario) -> None:
        """What else the plant gets."""

    def _after_finalizing(self, scenario: ServeScenario, builder: DiagramBuilder) -> None:
        """What else the diagram gets."""
