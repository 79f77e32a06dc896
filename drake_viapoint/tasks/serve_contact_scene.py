"""The serve's scene with contact: the ball can touch the same bodies, and joints rub."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    Meshcat,
    ProximityProperties,
    RoleAssign,
    SceneGraph,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction
from pydrake.multibody.tree import FixedOffsetFrame, Frame
from pydrake.systems.framework import Context, DiagramBuilder
from scipy.spatial.transform import Rotation

from drake_viapoint.errors import ModelFileError
from drake_viapoint.robot.inertia_draw import apply_inertias
from drake_viapoint.robot.joint_friction import add_coulomb_friction, add_viscous_friction
from drake_viapoint.tasks.hunt_crossley import dissipation, sphere_modulus
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.serve_surfaces import CapsuleRing, OvalPlate, cup_rings, goal_ring
from drake_viapoint.tasks.serve_unknown import TrialDraw, Unknown

_RIGID = 1e12  # [N/m] so that a pair is as compliant, and loses as much, as its other body says
_ROUGH = 1e6  # Drake takes a pair's friction as 2 a b / (a + b), so half of the other's is doubled


class ContactScene(ServeScene):
    """The serve's diagram in which the ball is carried, struck and landed by contact alone.

    Attributes:
        strings: The oval that strikes, about the racket's frame.
        cup_rings: Seat and wall of the cup, about its frame.
        goal_ring: The goal's ring, about its frame.
        dissipation: Of the ball on the strings [s/m], before it differs.
    """

    touches = True

    def __init__(self, scenario: ServeScenario, meshcat: Meshcat | None = None) -> None:
        contact = scenario.contact
        self.strings = OvalPlate(scenario.robot.half_width, scenario.robot.half_length)
        self.cup_rings = cup_rings(contact.cup_radius, scenario.ball.radius)
        self.goal_ring = goal_ring(contact.ring_radius, contact.ring_tube)
        self._config = scenario
        self.dissipation = dissipation(scenario.ball.restitution, contact.speed)
        super().__init__(scenario, meshcat)
        self._scene_graph: SceneGraph = self.diagram.GetSubsystemByName("scene_graph")
        # where the tool is held, in the tool
        self._grip: RigidTransform = self._mount.GetFixedPoseInBodyFrame()

    def unknown(self, seed: int) -> Unknown:
        """The robot of the run with this seed, and what its trials are like."""
        models = [self.instance, self.racket_frame.body().model_instance()]
        return Unknown(self._config.unknown, self.plant, models, seed)

    def differ(self, context: Context, unknown: Unknown, trial: TrialDraw) -> None:
        """Make robot, racket and ball what they really are, in the whole diagram's context."""
        own = self.plant.GetMyMutableContextFromRoot(context)
        apply_inertias(self.plant, own, unknown.inertias)
        self.ball.SetSpatialInertiaInBodyFrame(own, self._inertia)
        if trial.mount.any():
            self._mount.SetPoseInParentFrame(own, self._grip @ _turned(trial.mount))
        self._scene_graph.AssignRole(
            self._scene_graph.GetMyMutableContextFromRoot(context),
            self.plant.get_source_id(),
            self._ball_geometry,
            self._ball_surface(min(1.0, self._config.ball.restitution * trial.restitution)),
            RoleAssign.kReplace,
        )

    def seat_ball(self, own: Context) -> None:
        """Put the ball where it should rest in the cup, in the plant's context."""
        self.place_ball(own, self.cup_frame.CalcPoseInWorld(own).translation())

    def loosened(self, trial: TrialDraw) -> RigidTransform:
        """Pose of the real racket in the racket as the arm's model has it."""
        return self._grip @ _turned(-trial.mount) @ self._grip.inverse()

    def _ball_inboard(self) -> Frame:
        return self.plant.world_frame()

    def _before_finalizing(self, scenario: ServeScenario) -> None:
        contact, plant = scenario.contact, self.plant
        self._mount: FixedOffsetFrame = self._found_mount(scenario)
        self._ball_geometry: GeometryId = plant.RegisterCollisionGeometry(
            self.ball,
            RigidTransform(),
            Sphere(scenario.ball.radius),
            "ball",
            self._ball_surface(scenario.ball.restitution),
        )
        strings = ProximityProperties()
        AddContactMaterial(friction=_friction(contact.strings_friction), properties=strings)
        AddRigidHydroelasticProperties(strings)
        racket = self.racket_frame.body()
        plant.RegisterCollisionGeometry(
            racket,
            self.racket_frame.GetFixedPoseInBodyFrame(),
            self.strings.shape(),
            "strings",
            strings,
        )
        cup = _surface(contact.cup_stiffness, contact.cup_dissipation, contact.cup_friction)
        for name, ring in zip(("seat", "wall"), self.cup_rings, strict=True):
            self._register(f"cup_{name}", self.cup_frame, ring, cup)
        lost = dissipation(contact.ring_restitution, contact.speed)
        goal = _surface(contact.ring_stiffness, lost, contact.ring_friction)
        self._register("ring", self.ring_frame, self.goal_ring, goal)
        share = scenario.unknown.viscous_friction
        add_viscous_friction(plant, self.instance, share * self.arm.limits.effort)

    def _after_finalizing(self, scenario: ServeScenario, builder: DiagramBuilder) -> None:
        torque = scenario.unknown.coulomb_friction * self.arm.limits.effort
        if torque.any():
            add_coulomb_friction(builder, self.plant, self.instance, torque)
        # only the ball touches anything
        plant: SceneGraph = self.plant
        racket = plant.GetCollisionGeometriesForBody(self.racket_frame.body())
        goal = plant.GetCollisionGeometriesForBody(self.ring_frame.body())
        builder.GetSubsystemByName("scene_graph").collision_filter_manager().Apply(
            CollisionFilterDeclaration().ExcludeBetween(GeometrySet(racket), GeometrySet(goal))
        )

    def _found_mount(self, scenario: ServeScenario) -> FixedOffsetFrame:
        robot = scenario.robot
        named = self.plant.HasFrameNamed(robot.mount_frame)
        frame = self.plant.GetFrameByName(robot.mount_frame) if named else None
        if not isinstance(frame, FixedOffsetFrame):
            raise ModelFileError(
                scenario.scene,
                f"no frame {robot.mount_frame!r}, fixed to the tool, by which the arm holds it",
            )
        return frame

    def _register(
        self, name: str, frame: Frame, ring: CapsuleRing, surface: ProximityProperties
    ) -> None:
        place = frame.GetFixedPoseInBodyFrame()
        for number, (pose, capsule) in enumerate(ring.capsules()):
            self.plant.RegisterCollisionGeometry(
                frame.body(), place @ pose, capsule, f"{name}_{number}", surface
            )

    def _ball_surface(self, restitution: float) -> ProximityProperties:
        """The ball's: all compliance between it and the strings, none against anything else."""
        ball, contact = self._config.ball, self._config.contact
        lost = dissipation(restitution, contact.speed)
        surface = _surface(_RIGID, lost, _ROUGH)
        modulus = sphere_modulus(contact.strings_stiffness, ball.mass, ball.radius, contact.speed)
        AddCompliantHydroelasticProperties(contact.ball_mesh, modulus, surface)
        return surface


def _surface(stiffness: float, lost: float, friction: float) -> ProximityProperties:
    properties = ProximityProperties()
    AddContactMaterial(lost, stiffness, _friction(friction), properties)
    return properties


def _friction(pair: float) -> CoulombFriction:
    """What gives a pair this friction, together with the ball's."""
    return CoulombFriction(pair / 2, pair / 2)


def _turned(rotation_vector: NDArray[np.float64]) -> RigidTransform:
    return RigidTransform(RotationMatrix(Rotation.from_rotvec(rotation_vector).as_matrix()))
