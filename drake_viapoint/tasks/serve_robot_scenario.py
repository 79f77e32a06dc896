"""What makes a simulated serve like the real robot's: contact, ignorance and cameras.

Lengths in metres, masses in kilograms, angles in radians, times in seconds. Where no source is
named, a number is assumed.
"""

from dataclasses import dataclass, fields

from drake_viapoint.tasks.scenario import (
    require,
    require_not_negative,
    require_positive,
)


@dataclass
class ServeContact:
    """What the ball touches, and in which steps it is followed; only where execution is contact.

    Rigid bodies meet as in ``hunt_crossley``. The ball and the strings share one compliance, the
    cup and the goal's ring have their own.
    """

    strings_stiffness: float = 2e4
    """Of ball on strings [N/m]: a ball that meets them at ``speed`` is pressed as deep as by a
    linear spring, and stays for 5 ms, as balls on strings do."""
    speed: float = 4.0
    """Closing speed [m/s] at which stiffness and ball.restitution hold; slower balls spring back
    better."""
    strings_friction: float = 0.35
    """Of felt on strings: measured, 0.3 to 0.4."""
    ball_mesh: float = 0.005
    """Edge length of the ball's hydroelastic mesh [m]; rolled, such a ball presses by 0.2 % harder
    or softer."""
    cup_radius: float = 0.0345
    """Of the cup's hollow, inside its wall [m]."""
    cup_stiffness: float = 3e3
    """Of each of the eight places where the ball may rest [N/m]."""
    cup_dissipation: float = 10.0
    """Of the cup's lining [s/m]; the ball comes to rest in it within 0.1 s."""
    cup_friction: float = 0.3
    """Of felt on the cup's lining."""
    ring_radius: float = 0.125
    """Of the goal's ring, inside [m]."""
    ring_tube: float = 0.009
    """Radius of its tube, as its mesh has it [m]."""
    ring_stiffness: float = 2e4
    """Of ball on ring [N/m]."""
    ring_restitution: float = 0.6
    """Of the ball on the ring, at ``speed``."""
    ring_friction: float = 0.3
    """Of felt on the ring."""
    step: float = 1e-3
    """While the ball may touch something [s]; simulator.max_step_size holds while it flies."""

    def validate(self, contact: bool, ball_mass: float, ball_radius: float) -> None:
        """Check every value against its bounds.

        Args:
            contact: Whether trials are executed with contact; else no ball needs to fit.
            ball_mass: Of the ball [kg].
            ball_radius: Of the ball [m].

        Raises:
            ScenarioError: Names the value and the bound.
        """
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name.endswith(("friction", "dissipation")):
                require_not_negative(f"contact.{item.name}", value)
            else:
                require_positive(f"contact.{item.name}", value)
        bounce = self.ring_restitution
        require(bounce <= 1, "contact.ring_restitution", bounce, "must be in (0, 1]")
        require(1e-6 <= self.step <= 0.01, "contact.step", self.step, "must be in [1e-6, 0.01]")
        if contact:
            softest = ball_mass * (self.speed / ball_radius) ** 2
            require(
                self.strings_stiffness >= softest,
                "contact.strings_stiffness",
                self.strings_stiffness,
                f"must be at least {softest:.0f}, or the ball gives way by more than its radius",
            )
            coarsest = f"must be at most half the ball's radius, {ball_radius / 2:g}"
            require(
                self.ball_mesh <= ball_radius / 2, "contact.ball_mesh", self.ball_mesh, coarsest
            )
            widest = (
                f"must be at least the ball's radius {ball_radius:g}: the cup is smaller than the "
                "ball"
            )
            require(self.cup_radius >= ball_radius, "contact.cup_radius", self.cup_radius, widest)


@dataclass
class ServeUnknown:
    """What the robot is really like, which neither its controller nor the learner knows.

    Nothing by default, and only where execution is contact.
    """

    inertia: float = 0.0
    """Each link's mass is scaled by a factor within 1 - this and 1 + this, its moments a mass by
    another, drawn from the run's seed: one robot a run."""
    viscous_friction: float = 0.0
    """Of each joint, in efforts a rad/s [s/rad]."""
    coulomb_friction: float = 0.0
    """Of each joint, in efforts."""
    mount: float = 0.0
    """The racket sits turned in its mount, about each axis by an angle with this standard
    deviation [rad], drawn anew for each trial."""
    restitution: float = 0.0
    """The ball's restitution is scaled by a factor within 1 - this and 1 + this, drawn for each
    trial: a rough ball."""

    def validate(self, contact: bool) -> None:
        """Check every value against its bounds.

        Args:
            contact: Whether trials are executed with contact.

        Raises:
            ScenarioError: Names the value and the bound.
        """
        for item in fields(self):
            value = getattr(self, item.name)
            require(0 <= value < 1, f"unknown.{item.name}", value, "must be in [0, 1)")
            require(
                contact or value == 0, f"unknown.{item.name}", value, "needs execution: contact"
            )


@dataclass
class ServeCameras:
    """How a trial is seen; exactly by default.

    In section 2.1 two cameras see the centres of coloured blobs: ball, racket and goal.
    """

    see: str = "truth"
    """What the learner is told: truth, or what can be told from samples."""
    rate: float = 60.0
    """Samples a second [1/s]."""
    noise: float = 0.005
    """Standard deviation of each coordinate of a sample [m], so 9 mm in space (section 2.1.1: 5 to
    10, at 60 Hz)."""

    def validate(self) -> None:
        """Check every value against its bounds.

        Raises:
            ScenarioError: Names the value and the bound.
        """
        require(
            self.see in ("truth", "samples"), "cameras.see", self.see, "must be truth or samples"
        )
        require_positive("cameras.rate", self.rate)
        require_not_negative("cameras.noise", self.noise)
