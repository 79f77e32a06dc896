"""Everything an upswing depends on, as one YAML file says it.

The classes are filled by Drake's YAML reader, which needs them mutable and their annotations as
types, not as strings (so no postponed annotations here). Lengths in metres, masses in kilograms,
angles in radians, times in seconds.
"""

import math
from dataclasses import dataclass, field

from pydrake.multibody.plant import MultibodyPlantConfig
from pydrake.systems.analysis import SimulatorConfig

from drake_viapoint.tasks.jacobian_scenario import JacobianScenario
from drake_viapoint.tasks.scenario import (
    require,
    require_not_negative,
    require_one_of,
    require_positive,
    validate_simulation,
)


@dataclass
class UpswingDemonstration:
    """Whose upswing is watched, and how its via-points are found."""

    file: str = "package://drake_viapoint/demonstrations/upswing.c3d"
    """A marker file: a path, or an address in the package."""
    person: int = 0
    """Virtual person of the demonstration; 0 is the one in the shipped file."""
    hand: str = "hand"
    """Name of the marker on the pendulum's hinge."""
    tip: str = "tip"
    """Name of the marker at the pendulum's end."""
    cutoff: float = 8.0
    """Of the low-pass filter of the hand's path [Hz]."""
    end_angle: float | None = None
    """theta_d [rad]; measured from the tip's marker if not given."""
    end_speed: float | None = None
    """omega_d [rad/s]; measured from the tip's marker if not given."""
    via_points: int = 8
    """Number of via-points, ends included."""


@dataclass
class UpswingPendulum:
    """The robot's pendulum: a rod without mass, and a bob."""

    length: float = 0.35
    """Of the rod, l in the paper [m]."""
    mass: float = 0.05
    """Of the bob [kg]; only the arm that carries it feels it."""
    damping: float = 0.0
    """Viscous, as a share of the speed lost in a second [1/s]."""


@dataclass
class UpswingRobot:
    """The arm that swings, and how it is made to follow a path."""

    directives: str = "package://drake_viapoint/arm_with_axle.dmd.yaml"
    """Model directives of the arm and its tool: all that the controller knows."""
    arm: str = "arm"
    """Name of the arm's model instance."""
    tool_frame: str = "axle"
    """Frame whose pose the via-points describe."""
    line: list[float] = field(default_factory=lambda: [0.0, 0.44, 1.215])
    """Where the hand is at x = 0, in the world [m]; it moves along the world's x from there."""
    orientation: list[float] = field(default_factory=lambda: [0.0, 1.5707963267948966, 0.0])
    """ZYZ angles of the axle's frame [rad]; its y is the pendulum's axis and looks forward."""
    natural_frequency: float = 100.0
    """Of the tracking error's decay [rad/s]: the wrist is light beside the pendulum's pull, which
    the controller does not know of."""
    position_threshold: float = 1e-4
    """Supplemental via-points are added until the hand is this near to its path [m]: 1 mm is as
    much as a success forgives."""
    rotation_threshold: float = 1e-2
    """The same for its orientation [rad]."""


@dataclass
class UpswingLearning:
    """How the upswing is learned (section 3.3.2), and when it counts as learned."""

    control: list[str] = field(default_factory=lambda: [f"x{i}" for i in range(2, 8)])
    """The interior via-points: the paper's x1 to x6, which does not count the ends."""
    perturbation: float = 0.01
    """By which x of a via-point is explored [m]."""
    gain: list[float] = field(default_factory=lambda: [0.2, 0.02])
    """Diagonal of B, for theta and omega."""
    regularization: float = 0.1
    """lambda_J, for a Jacobian in tolerances a perturbation: as large as still lets the second,
    weak direction of the Jacobian be used [assumed]."""
    jacobian: JacobianScenario = field(default_factory=lambda: JacobianScenario(way="recorded"))
    """What becomes of the Jacobian; K = 12 in section 3.3."""
    angle_tolerance: float = 0.1
    """A successful trial ends nearer to theta_d than this [rad]."""
    speed_tolerance: float = 0.5
    """And nearer to omega_d than this [rad/s]."""
    successes: int = 3
    """So many successful trials in a row and the upswing is learned; 0 to go on to the end."""
    repeats: int = 0
    """Further trials with the learned movement unchanged."""


@dataclass
class UpswingScenario:
    """An upswing: who is watched, what swings, how it is executed and learned."""

    task: str = "upswing"
    """Name of the task; the first key of every scenario."""
    demonstration: UpswingDemonstration = field(default_factory=UpswingDemonstration)
    pendulum: UpswingPendulum = field(default_factory=UpswingPendulum)
    execution: str = "recurrence"
    """recurrence: the paper's difference equation. plant: Drake's, in continuous time."""
    hand: str = "kinematic"
    """In the plant. kinematic: the hand moves exactly as commanded. tracked: the arm carries it."""
    time_step: float = 1 / 60
    """Delta of the recurrence [s]."""
    robot: UpswingRobot = field(default_factory=UpswingRobot)
    learning: UpswingLearning = field(default_factory=UpswingLearning)
    plant: MultibodyPlantConfig = field(default_factory=lambda: MultibodyPlantConfig(time_step=0.0))
    """Drake's own configuration of the plant."""
    simulator: SimulatorConfig = field(
        default_factory=lambda: SimulatorConfig(
            integration_scheme="runge_kutta5", accuracy=1e-4, max_step_size=0.01
        )
    )
    """Drake's own configuration of the simulator."""
    seed: int = 0
    """Of the run; each trial's own seed follows from it."""
    made_with: dict[str, str] = field(default_factory=dict)
    """Versions of what executed a run; filled in when a run begins."""

    def validate(self) -> None:
        """Check every value against its bounds.

        Raises:
            ScenarioError: Names the value and the bound.
        """
        require(self.task == "upswing", "task", self.task, "must be upswing")
        require_one_of("execution", self.execution, ("recurrence", "plant"))
        require_one_of("hand", self.hand, ("kinematic", "tracked"))
        require_positive("time_step", self.time_step)
        self._validate_demonstration()
        for name in ("length", "mass"):
            require_positive(f"pendulum.{name}", getattr(self.pendulum, name))
        damping = self.pendulum.damping
        require_not_negative("pendulum.damping", damping)
        self._validate_robot()
        self._validate_learning()
        validate_simulation(self.plant, self.simulator)
        require(self.seed >= 0, "seed", self.seed, "must not be negative")

    def _validate_demonstration(self) -> None:
        watched = self.demonstration
        require(watched.person >= 0, "demonstration.person", watched.person, "must not be negative")
        require(
            watched.via_points >= 3,
            "demonstration.via_points",
            watched.via_points,
            "must be at least 3: the interior ones are learned",
        )
        require_positive("demonstration.cutoff", watched.cutoff)
        for name in ("end_angle", "end_speed"):
            value = getattr(watched, name)
            require(
                value is None or math.isfinite(value),
                f"demonstration.{name}",
                value,
                "must be finite",
            )

    def _validate_robot(self) -> None:
        robot = self.robot
        for name in ("line", "orientation"):
            value = getattr(robot, name)
            fits = len(value) == 3 and all(map(math.isfinite, value))
            require(fits, f"robot.{name}", value, "must be three numbers")
        for name in ("natural_frequency", "position_threshold", "rotation_threshold"):
            require_positive(f"robot.{name}", getattr(robot, name))

    def _validate_learning(self) -> None:
        learning = self.learning
        number = self.demonstration.via_points
        interior = [f"x{i}" for i in range(2, number)]
        require(
            sorted(learning.control) == sorted(interior),
            "learning.control",
            ", ".join(learning.control) or "none",
            f"must be the {len(interior)} interior ones of {number} via-points: "
            f"{', '.join(interior)}",
        )
        for name in ("perturbation", "angle_tolerance", "speed_tolerance"):
            require_positive(f"learning.{name}", getattr(learning, name))
        require(len(learning.gain) == 2, "learning.gain", learning.gain, "must be two")
        for value in learning.gain:
            require_positive("learning.gain", value)
        require_not_negative("learning.regularization", learning.regularization)
        learning.jacobian.validate("learning.jacobian")
        for name in ("successes", "repeats"):
            value = getattr(learning, name)
            require(value >= 0, f"learning.{name}", value, "must not be negative")
