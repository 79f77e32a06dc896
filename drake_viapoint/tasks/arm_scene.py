"""An arm with its tool in Drake, made to follow paths; tasks of an arm alone are executed in it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat
from pydrake.multibody.plant import MultibodyPlant, MultibodyPlantConfig
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.analysis import SimulatorConfig
from pydrake.systems.framework import DiagramBuilder

from drake_viapoint.errors import BrokenOffError, ModelFileError
from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.arm_motion import ArmMotion
from drake_viapoint.robot.inertia_draw import apply_inertias, draw_inertias
from drake_viapoint.robot.joint_friction import add_viscous_friction
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.robot.step_log import ArmLog
from drake_viapoint.robot.stepping import Stepping
from drake_viapoint.robot.tracking import Tracking
from drake_viapoint.tasks.arm_unknown import UnknownArm
from drake_viapoint.tasks.same_arm import ArmSources, require_same_arm
from drake_viapoint.tasks.scene import add_models, add_plant, scene_path


class Followed(NamedTuple):
    """What the arm did."""

    motion: ArmMotion
    clamped: NDArray[np.bool_]  # (k,) whether a joint's torque was clamped at a step


class ArmScene:
    """A diagram of an arm and its tool, built once and used for every trial.

    Args:
        directives: Model directives of the arm and its tool: a path, or an address in the package.
        tool_frame: Name of the tool's frame whose path matters.
        surroundings: Model directives that hold the arm, its tool and whatever stands around them,
            welded to the world; only the arm if None.
        unknown: How the arm that moves differs from what its controller believes.
        seed: What it is drawn from: another seed, another arm.
        natural_frequency: Of the tracking error's decay [rad/s].
        simulator: Integrator, accuracy and longest step; the serve's if None.
        meshcat: Where to show the scene, if anywhere.

    Attributes:
        arm: The controller's model of the arm.
        plant: What moves.
        instance: The arm in the plant.
        tracking: What makes the arm follow a movement.
        diagram: All of it.
        mount: Pose of the real tool in the tool as modelled.

    Raises:
        ModelFileError: A model cannot be read, a joint has no actuator, no frame has the name.
        ScenarioError: An unknown is out of its bounds, or the arm of ``surroundings`` is not the
            one of ``directives``.
    """

    def __init__(
        self,
        directives: str,
        tool_frame: str,
        *,
        surroundings: str | None = None,
        unknown: UnknownArm | None = None,
        seed: int = 0,
        natural_frequency: float = 28.0,
        simulator: SimulatorConfig | None = None,
        meshcat: Meshcat | None = None,
    ) -> None:
        self._given: dict[str, Any] = {
            "directives": directives,
            "tool_frame": tool_frame,
            "surroundings": surroundings,
            "unknown": unknown,
            "seed": seed,
            "natural_frequency": natural_frequency,
            "simulator": simulator,
        }
        unknown = unknown or UnknownArm()
        self.arm = Arm(scene_path(directives), tool_frame)
        effort = self.arm.limits.effort
        builder = DiagramBuilder()
        self.plant = add_plant(builder, MultibodyPlantConfig(time_step=0.0), meshcat)
        add_models(self.plant, surroundings or directives)
        self.instance = _actuated(self.plant, self.arm, surroundings or directives)
        add_viscous_friction(self.plant, self.instance, unknown.viscous_friction * effort)
        self.plant.Finalize()
        if surroundings is not None:
            sources = ArmSources("directives", "surroundings")
            require_same_arm(self.arm, self.plant, self.instance, tool_frame, sources)
        self.tracking = Tracking(builder, self.plant, self.instance, self.arm, natural_frequency)
        self.diagram = builder.Build()
        self.diagram.set_name("arm")

        bodies, mount = np.random.SeedSequence(seed).spawn(2)
        models = [self.instance, self.plant.GetFrameByName(tool_frame).model_instance()]
        self._inertias = draw_inertias(
            self.plant, sorted(set(models)), unknown.inertia, np.random.default_rng(bodies)
        )
        self.mount = unknown.draw_mount(np.random.default_rng(mount))
        self._stepping = Stepping(self.diagram, simulator or _steps())

    def shown(self, meshcat: Meshcat) -> ArmScene:
        """The same scene once more, to be looked at."""
        return ArmScene(**self._given, meshcat=meshcat)

    def follow(self, movement: JointMovement) -> Followed:
        """Integrate the arm through a movement, from rest where it begins.

        Raises:
            BrokenOffError: The integrator does not get to the end.
        """
        self.tracking.follow(movement.trajectory)
        try:
            return self._stepping.until_accepted(lambda: self._follow(movement))
        except RuntimeError as error:
            time = float(self._stepping.context.get_time())
            raise BrokenOffError(time, " ".join(str(error).split())) from error

    def _follow(self, movement: JointMovement) -> Followed:
        stepping, plant = self._stepping, self.plant
        stepping.reset(float(movement.times[0]))
        own = plant.GetMyMutableContextFromRoot(stepping.context)
        apply_inertias(plant, own, self._inertias)
        plant.SetPositions(own, self.instance, movement.angles[0])
        log = ArmLog(plant, self.instance, self.tracking, stepping.context)

        def record() -> bool:
            log.add()
            return False

        stepping.advance(float(movement.times[-1]), record)
        return Followed(ArmMotion([log.segment()]), log.clamped())


def _steps() -> SimulatorConfig:
    return SimulatorConfig(integration_scheme="runge_kutta5", accuracy=1e-3, max_step_size=0.018)


def _actuated(plant: MultibodyPlant, arm: Arm, address: str) -> ModelInstanceIndex:
    """The model that has the arm's joints."""
    for number in range(plant.num_model_instances()):
        instance = ModelInstanceIndex(number)
        if all(plant.HasJointNamed(name, instance) for name in arm.joint_names):
            return instance
    raise ModelFileError(address, f"no model has the joints {', '.join(arm.joint_names)}")
