"""Two model files that should hold the same arm: the controller's, and what moves in the scene."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from drake_viapoint.errors import ScenarioError
from drake_viapoint.robot.arm import Arm, moving_joints

_SAME = 1e-6  # apart from rounding in what files say [m, rad, share of a limit or an inertia]


class ArmSources(NamedTuple):
    """What the two files are called, to whoever has named them."""

    controller: str = "robot.directives"
    scene: str = "scene"


def require_same_joints(
    arm: Arm, plant: MultibodyPlant, instance: ModelInstanceIndex, sources: ArmSources
) -> None:
    """Check that a scene's arm has the joints of the controller's, before anything else.

    Args:
        arm: The controller's model.
        plant: Of the scene, finalised or not.
        instance: The arm in it.
        sources: What the two are called.

    Raises:
        ScenarioError: The names differ; says both.
    """
    found = tuple(joint.name() for joint in moving_joints(plant, instance))
    expected = arm.joint_names
    if plant.is_finalized() or sorted(found) != sorted(expected):
        _require(
            found == expected,
            sources,
            f"the arm of {sources.controller} ({' '.join(expected)}) is not the arm of "
            f"{sources.scene} ({' '.join(found) or 'no joints'})",
        )


def require_same_arm(
    arm: Arm,
    plant: MultibodyPlant,
    instance: ModelInstanceIndex,
    tool_frame: str,
    sources: ArmSources,
) -> None:
    """Check that a scene's arm is the one its controller knows.

    Compared are joints and their limits, posture at rest, pose of the tool there, and the inertias
    of the arm's links and of the tool.

    Args:
        arm: The controller's model.
        plant: Of the scene, finalised.
        instance: The arm in it.
        tool_frame: Name of the tool's frame.
        sources: What the two are called.

    Raises:
        ScenarioError: Something differs; names the first that does, with both values.
    """
    require_same_joints(arm, plant, instance, sources)
    differs = f"the arm of {sources.controller} is not the arm of {sources.scene}: "
    context = plant.CreateDefaultContext()
    joints = moving_joints(plant, instance)
    compared = {
        "lower limit": (arm.limits.lower, [j.position_lower_limits() for j in joints]),
        "upper limit": (arm.limits.upper, [j.position_upper_limits() for j in joints]),
        "greatest speed": (arm.limits.speed, [j.velocity_upper_limits() for j in joints]),
        "angle at rest": (arm.rest, plant.GetPositions(context, instance)),
    }
    for what, (ours, others) in compared.items():
        theirs = np.ravel(others)
        for name, a, b in zip(arm.joint_names, ours, theirs, strict=True):
            _require(_close(a, b), sources, f"{differs}{what} of {name} {a:g} and {b:g}")

    rotation, place = arm.tool_pose(arm.rest)
    frame = plant.GetFrameByName(tool_frame)
    pose = frame.CalcPoseInWorld(context)
    there = f"{differs}at rest {tool_frame} is "
    _require(
        bool(np.linalg.norm(place - pose.translation()) <= _SAME),
        sources,
        f"{there}at {_triple(place)} m and at {_triple(pose.translation())} m",
    )
    chord = np.linalg.norm(rotation - pose.rotation().matrix()) / np.sqrt(8)
    turned = 2 * np.arcsin(min(1.0, chord))  # [rad], of any size
    _require(bool(turned <= _SAME), sources, f"{there}turned by {turned:.3g} rad")

    controller = arm.plant
    ours_inertia = _inertias(
        controller,
        controller.GetJointByName(arm.joint_names[0]).model_instance(),
        controller.GetFrameByName(tool_frame).model_instance(),
    )
    theirs_inertia = _inertias(plant, instance, frame.model_instance())
    nothing = np.zeros((6, 6))
    for name in dict.fromkeys([*ours_inertia, *theirs_inertia]):
        x, y = ours_inertia.get(name, nothing), theirs_inertia.get(name, nothing)
        same = np.linalg.norm(x - y) <= _SAME * max(np.linalg.norm(x), np.linalg.norm(y))
        masses = f"mass of {name} {x[5, 5]:g} kg and {y[5, 5]:g} kg"
        what = masses if not _close(x[5, 5], y[5, 5]) else f"moments of inertia of {name}"
        _require(bool(same), sources, differs + what)


def _require(condition: bool, sources: ArmSources, fault: str) -> None:
    if not condition:
        raise ScenarioError(f"{fault}; change {sources.controller} and {sources.scene} together")


def _close(a: float, b: float) -> bool:
    return a == b or abs(a - b) <= _SAME * max(1.0, abs(a), abs(b))


def _triple(place: NDArray[np.float64]) -> str:
    return f"({', '.join(f'{value:.4g}' for value in place + 0.0)})"


def _inertias(plant: MultibodyPlant, *models: ModelInstanceIndex) -> dict[str, NDArray[np.float64]]:
    """Spatial inertias (6, 6) of the bodies of models that have a mass, by name."""
    context = plant.CreateDefaultContext()
    bodies = [
        plant.get_body(index)
        for model in dict.fromkeys(models)
        for index in plant.GetBodyIndices(model)
    ]
    return {
        body.name(): body.CalcSpatialInertiaInBodyFrame(context).CopyToFullMatrix6()
        for body in bodies
        if body.default_mass() > 0
    }
