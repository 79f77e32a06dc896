"""Compliant contact as Drake has it: force f(x) (1 + d v), at depth x and closing speed v.

Hunt & Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech. 42
(1975). Whatever the elastic force f, a body of mass m that meets another at speed v and leaves it
at speed w obeys
    d v - ln(1 + d v)  =  -d w - ln(1 - d w),
since both sides are d^2 / m times the work of f up to the deepest point. So restitution depends on
the dissipation and the speed alone, and falls with the speed.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

_NEARLY_ELASTIC = 0.999  # above, 1 / (1 + 2 d v / 3) is exact to 1e-9, and the logarithms are not


def dissipation(restitution: float, speed: float) -> float:
    """Dissipation d [s/m] that gives a restitution at a closing speed.

    Args:
        restitution: Ratio of the speeds after and before, in (0, 1].
        speed: Closing speed [m/s].
    """
    if restitution > _NEARLY_ELASTIC:
        return 1.5 * (1 / restitution - 1) / speed

    def surplus(y: float) -> float:
        w = -np.expm1(-y)  # by y = -ln(1 - w), as w may come as near to 1 as it likes
        u = w / restitution
        return float((y - w) - (u - np.log1p(u)))

    y = brentq(surplus, 1e-4, 1 / restitution + 40.0, xtol=1e-14)
    return float(-np.expm1(-y) / restitution) / speed


def restitution(dissipation: float, speed: float) -> float:
    """Restitution at a closing speed [m/s], of a dissipation [s/m]."""
    u = dissipation * speed
    if 1 / (1 + 2 * u / 3) > _NEARLY_ELASTIC:
        return 1 / (1 + 2 * u / 3)
    work = u - np.log1p(u)
    y = brentq(lambda y: float(y + np.expm1(-y)) - work, 0.0, work + 2.0, xtol=1e-14)
    return float(-np.expm1(-y) / u)


def sphere_modulus(stiffness: float, mass: float, radius: float, speed: float) -> float:
    """Hydroelastic modulus [Pa] of a ball that presses against a flat like a linear spring.

    The ball's pressure grows evenly from its surface to its centre. At this speed it is pressed as
    deep as by the spring, ``x = speed sqrt(mass / stiffness)``, and so stores the same energy.

    Args:
        stiffness: Of the spring [N/m].
        mass: Of the ball [kg].
        radius: Of the ball [m].
        speed: Closing speed [m/s].
    """
    depth = speed * np.sqrt(mass / stiffness)
    energy_per_modulus = np.pi * (depth**3 / 3 - depth**4 / (6 * radius))
    return float(0.5 * mass * speed**2 / energy_per_modulus)
