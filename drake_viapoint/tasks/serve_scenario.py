"""Everything a serve depends on, as one YAML file says it.

The classes are filled by Drake's YAML reader, which needs them mutable and their annotations as
types, not as strings (so no postponed annotations here). Lengths in metres, masses in kilograms,
angles in radians, times in seconds.
"""

from dataclasses import dataclass, field

from pydrake.multibody.plant import MultibodyPlantConfig
from pydrake.systems.analysis import SimulatorConfig

from drake_viapoint.robot.retargeting import POSE_NAMES
from drake_viapoint.tasks.jacobian_scenario import JacobianScenario
from drake_viapoint.tasks.scenario import (
    require,
    require_components,
    require_not_negative,
    require_one_of,
    require_positive,
    validate_simulation,
)
from drake_viapoint.tasks.serve_robot_scenario import ServeCameras, ServeContact, ServeUnknown

_NOT_WITH_CONTACT = "must be 0 with contact"


@dataclass
class ServeDemonstration:
    """Whose serve is watched, and how its via-points are found."""

    file: str = "package://drake_viapoint/demonstrations/serve.c3d"
    """A marker file: a path, or an address in the package."""
    person: int = 0
    """Virtual person of the demonstration; 0 is the one in the shipped file."""
    markers: list[str] = field(default_factory=lambda: ["racket_upper", "racket_lower", "wrist"])
    """Names of the markers at the face's upper and lower edge and at the wrist."""
    cutoff: float = 12.0
    """Of the low-pass filter [Hz]."""
    hit_time: float | None = None
    """t_HIT [s]; found from the spike in acceleration if not given."""
    via_points: int = 8
    """Number of via-points, ends included."""
    angle_weight: float = 0.3
    """Lever that makes angles comparable with positions in the extraction [m/rad]."""


@dataclass
class ServeRobot:
    """The arm that serves, and how it is made to follow a path."""

    directives: str = "package://drake_viapoint/arm_with_racket.dmd.yaml"
    """Model directives of the arm and its tool: all that the controller knows."""
    arm: str = "arm"
    """Name of the arm's model instance."""
    tool_frame: str = "racket"
    """Frame whose pose the via-points describe."""
    cup_frame: str = "cup"
    """Frame of the cup that carries the ball."""
    mount_frame: str = "handle"
    """Where the tool is held: a frame fixed to it by which it is welded to the arm."""
    natural_frequency: float = 28.0
    """Of the tracking error's decay [rad/s]. Enough to keep the first trial within 2 mm of its path
    though the controller does not know of the ball; from 30 on the integrator has to halve its
    steps."""
    position_threshold: float = 1e-3
    """Supplemental via-points are added until the tool is this near to its path [m]."""
    rotation_threshold: float = 1e-2
    """The same for its orientation [rad]."""
    half_width: float = 0.115
    """Of the oval that strikes the ball, along x_racket [m]."""
    half_length: float = 0.155
    """Of the oval that strikes the ball, along z_racket [m]."""


@dataclass
class ServeBall:
    """The robot's ball."""

    body: str = "ball"
    """Name of the ball's body."""
    mass: float = 0.058
    """Of the ball [kg]: 56.0 to 59.4 g for a tennis ball (ITF rules)."""
    radius: float = 0.033
    """Of the ball [m]: 32.7 to 34.3 mm for a tennis ball (ITF rules)."""
    restitution: float = 0.8
    """On the face, of the normal relative speed [assumed; between hand-held and clamped]. With
    contact, of the ball on strings held fast: what the racket takes comes on top."""
    drag_coefficient: float = 0.0
    """0.507 for a tennis ball at 15-30 m/s; off by default, as in the paper's simulation."""


@dataclass
class ServeDisturbance:
    """What differs from trial to trial whatever the arm does; nothing by default.

    Section 3.2 disturbs release and bounce by 3 %.
    """

    release: float = 0.0
    """Each component of the ball's velocity as it leaves the cup is scaled by a factor of its own,
    drawn evenly from 1 - this to 1 + this."""
    bounce: float = 0.0
    """The same as it leaves the face."""


@dataclass
class ThrowLearning:
    """Subtask 1: throw the ball so that the face's centre meets it (section 2.1.2)."""

    control: list[str] = field(default_factory=lambda: ["x3", "y3", "z3", "x4", "y4", "z4"])
    """S_H, the components that subtask 1 changes."""
    gain: float = 0.5
    """Diagonal of B_H (Eq. 1)."""
    regularization: float = 0.04
    """lambda_J, for a Jacobian in tolerances a perturbation: a direction in which one perturbation
    moves the ball by less than a fifth of the meeting tolerance, 1 cm, is hardly used [assumed]."""
    reached: float = 0.03
    """Subtask 2 starts once d is below this [m]: it moves d by up to 2 cm, and 5 cm is the bar
    [assumed]."""


@dataclass
class StrikeLearning:
    """Subtask 2: strike the ball into the goal (sections 2.1.3 and 2.2.2)."""

    control: list[str] = field(default_factory=lambda: ["phi6", "phi7", "psi7"])
    """S_G, the components that subtask 2 changes."""
    gain: float = 0.4
    """alpha of B_G (Eq. 4) up to taper_start."""
    taper_start: float = 0.05
    """d from which on the gain falls [m]."""
    gate: float = 0.1
    """The gain falls from taper_start to 0 at this d [m]; a trial beyond serves subtask 1."""
    regularization: float = 0.0064
    """As for the throw: here, too, 1 cm a perturbation, of a landing tolerance of 12.5 cm
    [assumed]."""


@dataclass
class ServeLearning:
    """How the serve is learned, and when it counts as learned."""

    throw: ThrowLearning = field(default_factory=ThrowLearning)
    strike: StrikeLearning = field(default_factory=StrikeLearning)
    position_perturbation: float = 0.01
    """By which x, y and z of a via-point are explored, in either subtask [m]."""
    angle_perturbation: float = 0.017453292519943295
    """The same of phi, theta and psi [rad]: 1 degree."""
    jacobian: JacobianScenario = field(default_factory=lambda: JacobianScenario(window=15))
    """What becomes of both Jacobians; K = 15 in section 3.2."""
    meeting_tolerance: float = 0.05
    """A successful trial has d below this [m]."""
    landing_tolerance: float = 0.125
    """And lands this near to the goal's centre [m]: the ring's radius."""
    successes: int = 3
    """So many successful trials in a row and the serve is learned."""
    repeats: int = 5
    """Further trials with the learned movement unchanged, as at the end of section 2.1.3."""


@dataclass
class ServeScenario:
    """A serve: who is watched, who serves, with what, how it is executed and learned."""

    task: str = "serve"
    """Name of the task; the first key of every scenario."""
    demonstration: ServeDemonstration = field(default_factory=ServeDemonstration)
    robot: ServeRobot = field(default_factory=ServeRobot)
    scene: str = "package://drake_viapoint/serve.dmd.yaml"
    """Model directives of arm, racket, ball and goal; the goal's centre is the frame `ring`."""
    ring_frame: str = "ring"
    """Frame at the centre of the goal's ring."""
    ball: ServeBall = field(default_factory=ServeBall)
    disturbance: ServeDisturbance = field(default_factory=ServeDisturbance)
    learning: ServeLearning = field(default_factory=ServeLearning)
    execution: str = "event"
    """event: the ball is released, struck and landed by events, as in the paper's simulation.
    contact: Drake's contact carries, throws and strikes it, as it does on a robot. Begin with the
    scenario serve_robot.yaml then: with the plant and the simulator as they are here, for events, a
    trial takes ten times as long."""
    contact: ServeContact = field(default_factory=ServeContact)
    unknown: ServeUnknown = field(default_factory=ServeUnknown)
    cameras: ServeCameras = field(default_factory=ServeCameras)
    plant: MultibodyPlantConfig = field(default_factory=lambda: MultibodyPlantConfig(time_step=0.0))
    """Drake's own configuration of the plant."""
    simulator: SimulatorConfig = field(
        default_factory=lambda: SimulatorConfig(
            integration_scheme="runge_kutta5", accuracy=1e-3, max_step_size=0.018
        )
    )
    """Drake's own configuration of the simulator. Steps of 18 ms land within 0.03 mm of the limit.
    The accuracy only stands guard: where a step errs by more, all are halved."""
    seed: int = 0
    """Of the run; each trial's own seed follows from it."""
    made_with: dict[str, str] = field(default_factory=dict)
    """Versions of what executed a run; filled in when a run begins."""

    def validate(self) -> None:
        """Check every value against its bounds.

        Raises:
            ScenarioError: Names the value and the bound.
        """
        require(self.task == "serve", "task", self.task, "must be serve")
        require_one_of("execution", self.execution, ("event", "contact"))
        for name in ("mass", "radius"):
            require_positive(f"ball.{name}", getattr(self.ball, name))
        restitution, drag = self.ball.restitution, self.ball.drag_coefficient
        require(0 < restitution <= 1, "ball.restitution", restitution, "must be in (0, 1]")
        require(0 <= drag <= 10, "ball.drag_coefficient", drag, "must be in [0, 10]")
        contact = self.execution == "contact"
        require(not contact or drag == 0, "ball.drag_coefficient", drag, _NOT_WITH_CONTACT)
        for name in ("release", "bounce"):
            share = getattr(self.disturbance, name)
            require(0 <= share < 1, f"disturbance.{name}", share, "must be in [0, 1)")
            require(not contact or share == 0, f"disturbance.{name}", share, _NOT_WITH_CONTACT)
        for name in (
            "natural_frequency",
            "position_threshold",
            "rotation_threshold",
            "half_width",
            "half_length",
        ):
            require_positive(f"robot.{name}", getattr(self.robot, name))
        watched = self.demonstration
        require(watched.person >= 0, "demonstration.person", watched.person, "must not be negative")
        require(
            watched.via_points >= 2, "demonstration.via_points", watched.via_points, "at least 2"
        )
        require(
            len(watched.markers) == 3, "demonstration.markers", watched.markers, "must be three"
        )
        require_positive("demonstration.cutoff", watched.cutoff)
        require_positive("demonstration.angle_weight", watched.angle_weight)
        self._validate_learning()
        self.contact.validate(contact, self.ball.mass, self.ball.radius)
        self.unknown.validate(contact)
        self.cameras.validate()
        validate_simulation(self.plant, self.simulator, contact=contact)
        require(self.seed >= 0, "seed", self.seed, "must not be negative")

    def _validate_learning(self) -> None:
        learning = self.learning
        for name, subtask in (("throw", learning.throw), ("strike", learning.strike)):
            require_positive(f"learning.{name}.gain", subtask.gain)
            require_not_negative(f"learning.{name}.regularization", subtask.regularization)
            require(bool(subtask.control), f"learning.{name}.control", [], "must not be empty")
            require_components(
                f"learning.{name}.control",
                subtask.control,
                POSE_NAMES,
                self.demonstration.via_points,
            )
        require_positive("learning.position_perturbation", learning.position_perturbation)
        require_positive("learning.angle_perturbation", learning.angle_perturbation)
        learning.jacobian.validate("learning.jacobian")
        require_positive("learning.throw.reached", learning.throw.reached)
        require_positive("learning.strike.gate", learning.strike.gate)
        require(
            0 <= learning.strike.taper_start < learning.strike.gate,
            "learning.strike.taper_start",
            learning.strike.taper_start,
            "must lie between 0 and the gate",
        )
        require_positive("learning.meeting_tolerance", learning.meeting_tolerance)
        require_positive("learning.landing_tolerance", learning.landing_tolerance)
        require(learning.successes >= 1, "learning.successes", learning.successes, "at least 1")
        require(learning.repeats >= 0, "learning.repeats", learning.repeats, "must not be negative")
