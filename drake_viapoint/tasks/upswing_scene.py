"""The upswing's scene in Drake: an arm and the pendulum it holds, and the control of the arm."""

from __future__ import annotations

from pydrake.geometry import Meshcat
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.tree import FixedOffsetFrame
from pydrake.systems.framework import Context, DiagramBuilder

from drake_viapoint.errors import ModelFileError
from drake_viapoint.motion.orientation import rotation_from_zyz
from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.tracking import Tracking
from drake_viapoint.tasks.scene import add_models, add_plant, scene_path
from drake_viapoint.tasks.upswing_line import HandLine
from drake_viapoint.tasks.upswing_pendulum import hang_pendulum
from drake_viapoint.tasks.upswing_scenario import UpswingScenario


class UpswingScene:
    """The upswing's diagram, built once and used for every trial.

    The pendulum hangs on a frame that is parallel to the world's while the hand is held as the
    scenario says; so its joint's angle is theta. The controller knows the arm, not the pendulum.

    Args:
        scenario: Models, pendulum and control.
        meshcat: Where to show the scene, if anywhere.

    Attributes:
        arm: The controller's model of the arm.
        line: Where the hand moves.
        plant: Arm and pendulum.
        instance: The arm in the plant.
        joint: The pendulum's.
        tracking: The controller.
        diagram: All of it.

    Raises:
        ModelFileError: A model cannot be read, or lacks the arm or a frame.
        ScenarioError: The line starts out of reach, or the axle does not look forward.
    """

    def __init__(self, scenario: UpswingScenario, meshcat: Meshcat | None = None) -> None:
        robot = scenario.robot
        self.arm = Arm(scene_path(robot.directives), robot.tool_frame)
        builder = DiagramBuilder()
        self.plant = add_plant(builder, scenario.plant, meshcat)
        add_models(self.plant, robot.directives)
        try:
            self.instance = self.plant.GetModelInstanceByName(robot.arm)
            axle = self.plant.GetFrameByName(robot.tool_frame)
        except RuntimeError as error:
            raise ModelFileError(robot.directives, " ".join(str(error).split())) from error
        self.line = HandLine(robot, self.arm)
        upright = RotationMatrix(rotation_from_zyz(robot.orientation)).inverse()
        hinge = self.plant.AddFrame(FixedOffsetFrame("hinge", axle, RigidTransform(upright)))
        self.joint = hang_pendulum(self.plant, hinge, scenario.pendulum)
        self.plant.Finalize()
        self.tracking = Tracking(
            builder, self.plant, self.instance, self.arm, robot.natural_frequency
        )
        self.diagram = builder.Build()
        self.diagram.set_name("upswing")

    def put(self, context: Context, x: float, angle: float) -> None:
        """Hold the hand at a place x [m] and the pendulum at an angle theta [rad].

        Args:
            context: The plant's.
            x: Along the line.
            angle: Of the pendulum.

        Raises:
            UnreachableError: The arm does not reach the place.
        """
        self.plant.SetPositions(context, self.instance, self.line.posture(x))
        self.joint.set_angle(context, angle)
