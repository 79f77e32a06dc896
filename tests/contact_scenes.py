"""The scene with contact, for tests: one scenario, and a ball thrown at an arm held fast."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator

from drake_viapoint.packages import resolve
from drake_viapoint.tasks.catalogue import ROBOT_SERVE, task_scenario
from drake_viapoint.tasks.serve_contact_scene import ContactScene
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_unknown import AVERAGE as AVERAGE

NOTHING_UNKNOWN = dict.fromkeys(
    (
        "unknown.inertia",
        "unknown.viscous_friction",
        "unknown.coulomb_friction",
        "unknown.mount",
        "unknown.restitution",
    ),
    0.0,
)


def robot_scenario(changes: dict[str, object] | None = None) -> ServeScenario:
    """The shipped robot's scenario, with changes."""
    scenario: ServeScenario = task_scenario("serve", resolve(ROBOT_SERVE), changes)
    return scenario


class FixedRacket:
    """A ball and a racket that nothing moves: the arm's joints are locked where they rest."""

    def __init__(self, scenario: ServeScenario) -> None:
        self.scenario = scenario
        self.scene = ContactScene(scenario)
        self.simulator = Simulator(self.scene.diagram)
        self.context = self.simulator.get_mutable_context()
        self.own = self.scene.plant.GetMyMutableContextFromRoot(self.context)

    def throw(
        self,
        centre: NDArray[np.float64],
        velocity: NDArray[np.float64],
        spin: NDArray[np.float64] | None = None,
        step: float = 5e-5,
    ) -> None:
        """Put the ball there, in the racket's frame, moving and spinning so."""
        scene, plant = self.scene, self.scene.plant
        scene.diagram.SetDefaultContext(self.context)
        ApplySimulatorConfig(self.scenario.simulator, self.simulator)
        self.simulator.get_mutable_integrator().set_maximum_step_size(step)
        for index in plant.GetJointIndices(scene.instance):
            joint: Any = plant.get_joint(index)
            if joint.num_velocities() == 1:
                joint.Lock(self.own)
        scene.differ(self.context, scene.unknown(0), AVERAGE)
        racket = scene.racket_frame.CalcPoseInWorld(self.own)
        scene.place_ball(self.own, racket.multiply(centre))
        turn = racket.rotation()
        turning = np.zeros(3) if spin is None else turn.multiply(spin)
        velocities = np.concatenate([turning, turn.multiply(velocity)])
        joint = next(
            plant.get_joint(i)
            for i in plant.GetJointIndices()
            if plant.get_joint(i).name() == "carry"
        )
        plant.SetVelocities(
            self.own, self._with_ball(plant.GetVelocities(self.own), joint, velocities)
        )
        self.simulator.Initialize()

    def go(self, end: float) -> None:
        """Integrate to a time [s]."""
        self.simulator.AdvanceTo(end)

    def ball(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The ball's centre, velocity and spin, in the racket's frame."""
        scene = self.scene
        racket = scene.racket_frame.CalcPoseInWorld(self.own)
        place = scene.plant.EvalBodyPoseInWorld(self.own, scene.ball).translation()
        moving = scene.plant.EvalBodySpatialVelocityInWorld(self.own, scene.ball)
        back = racket.rotation().inverse()
        return (
            racket.inverse().multiply(place),
            back.multiply(moving.translational()),
            back.multiply(moving.rotational()),
        )

    def energy(self) -> float:
        """Kinetic, and potential in gravity [J]; what the ball's compression holds comes on top."""
        plant = self.scene.plant
        kinetic = plant.CalcKineticEnergy(self.own)
        return float(kinetic + plant.CalcPotentialEnergy(self.own))

    @staticmethod
    def _with_ball(
        all_of_them: NDArray[np.float64], joint: Any, ball: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        start = joint.velocity_start()
        all_of_them[start : start + 6] = ball
        return all_of_them
