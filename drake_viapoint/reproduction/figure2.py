"""Our Fig. 2: position, velocity and acceleration of the racket's centre, and the hit in them."""

from __future__ import annotations

from matplotlib.figure import Figure

from drake_viapoint.demonstration.impact import racket_centre_derivatives
from drake_viapoint.reproduction.style import SYNTHETIC, VIA_POINT
from drake_viapoint.tasks.serve_demonstration import WatchedServe


def draw(watched: WatchedServe) -> Figure:
    """Draw the unfiltered markers' motion, differentiated numerically."""
    motion = racket_centre_derivatives(watched.recording, watched.markers)
    hit = watched.hit_time + float(watched.recording.times[0])
    figure = Figure(figsize=(7, 7), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    rows = (
        (motion.position, "position [m]"),
        (motion.velocity, "velocity [m/s]"),
        (motion.acceleration, "acceleration [m/s²]"),
    )
    for ax, (values, label) in zip(axes, rows, strict=True):
        for column, name in enumerate("xyz"):
            ax.plot(motion.times, values[:, column], label=name, linewidth=1)
        ax.axvline(hit, color=VIA_POINT, linestyle="--", label=f"$t_{{HIT}}$ = {hit:.3f} s")
        ax.set_ylabel(label)
    axes[0].legend(ncols=4, fontsize=8)
    axes[-1].set_xlabel("time [s]")
    figure.suptitle("Racket centre" + (f" ({SYNTHETIC})" if watched.synthetic else ""), fontsize=10)
    return figure
