"""What the page says of each picture: the paper's caption in our words, and what is to be seen.

Every picture names the file it is in. Where ours shows more than the paper's, or something else,
the caption says so.
"""

from __future__ import annotations

from drake_viapoint.reproduction.findings import Picture

_D = "Crosses: distance d from the ball to the racket's centre when it should be hit. Circles: "
_CURVE = _D + "distance of the landing from the goal. "

PICTURES = {
    picture.file: picture
    for picture in (
        Picture(
            "figure2.png",
            "Our Fig. 2",
            "Position, velocity and acceleration of the racket's centre in the demonstration. "
            "Velocity and acceleration are differences of unfiltered samples, so the hit is seen "
            "as a spike.",
            "Three curves over time: position, velocity and acceleration of the racket's centre, "
            "the acceleration with a spike at the hit.",
        ),
        Picture(
            "figure3.png",
            "Our Fig. 3",
            "How via-points are found: start and end are joined by a minimum-jerk path (left), a "
            "via-point is put where it is furthest from what was watched (middle), and so on "
            "(right).",
            "Three steps of extraction: the generated path comes closer to the watched one with "
            "each via-point.",
        ),
        Picture(
            "figure4.png",
            "Our Fig. 4",
            "Via-points of the demonstration and the minimum-jerk path through them: position x "
            "to the right, y ahead, z up, and the Z-Y-Z angles φ, θ, ψ of the racket.",
            "Six panels over time, one for each of x, y, z, φ, θ and ψ: the watched curve, the "
            "via-points on it, and the path through them, which keeps close to it.",
        ),
        Picture(
            "figure5.png",
            "Our Fig. 5",
            "From the racket to the joints. Smooth joints between via-points alone let the racket "
            "stray from its path; supplemental via-points, put where it strays most, bring it "
            "back.",
            "Joint angles over time, and the racket's distance from its desired path without and "
            "with supplemental via-points.",
        ),
        Picture(
            "figure8.png",
            "Our Fig. 8",
            "The simulated robot of the serve as it starts: the arm, the racket with the ball in "
            "its cup, the via-points and the path of the racket's centre through them, the ball's "
            "path in the first trial, and the goal.",
            "The arm from the front and from the right, its racket, eight numbered via-points on a "
            "path, and the path of a ball that ends beyond the goal's ring.",
        ),
        Picture(
            "serve_views.png",
            "The serve in the simulation",
            "As our Fig. 6, by events instead of contact and without a robot's doubts: first "
            "trial, the last trial that learned the throw, and the end.",
            "Three columns of three views, x-y, x-z and y-z: the arm as it hits, the racket, the "
            "ball's path and the goal; in the last column the ball ends in the goal.",
        ),
        Picture(
            "serve_curve.png",
            "Learning curve of the simulated serve",
            "As our Fig. 7, by events. " + _CURVE + "Below: what each trial was made for.",
            "Two curves over the trials: d, small from the start, and the landing, which falls "
            "below its dotted bar once the throw is learned; below, marks of what each trial was "
            "made for.",
        ),
        Picture(
            "figure9.png",
            "Our Fig. 9",
            "What moving each via-point component does: to the ball when it should be hit (upper), "
            "to the landing (middle), and to the landing for what it does to the throw (lower). "
            "Dark: positions; light: angles.",
            "Three bar charts over the 48 components of eight via-points; the components chosen "
            "for each subtask stand out.",
        ),
        Picture(
            "persons.png",
            "The serve from many persons",
            "At which trial the serve of each virtual person was learned, exploration included. "
            "The paper has one person.",
            "A bar for each virtual person, as high as the trial at which the serve was learned; "
            "crosses where it was not.",
        ),
        Picture(
            "figure10.png",
            "Our Fig. 10",
            "Learning curves under the three conditions of section 3.2, of all runs; explored by "
            "5 cm and 5°. Black: distance d from the ball to the racket's centre. Blue: distance "
            "of the landing from the goal. Thin: single runs; band and line: quartiles and median. "
            "Below each panel: what the trials were made for.",
            "Three panels, undisturbed, disturbed with Jacobians kept and disturbed with Jacobians "
            "estimated anew: bundles of curves that fall with the trials.",
        ),
        Picture(
            "figure10_small.png",
            "Our Fig. 10, explored by less",
            "The same, explored by 1 cm and 1°: less than what the disturbance does to a ball.",
            "Three panels like those of Fig. 10; the bundles of the disturbed conditions fall more "
            "slowly.",
        ),
        Picture(
            "figure6.png",
            "Our Fig. 6",
            "Three views of the simulated robot's serve: the first trial (left), the last trial "
            "that learned the throw (middle), and the last movement again and again (right). The "
            "stick figure is the arm when it should hit.",
            "Three columns of three views, x-y, x-z and y-z: the arm as it hits, the racket, the "
            "paths of the ball and the goal; in the last column six paths lie close together.",
        ),
        Picture(
            "figure7.png",
            "Our Fig. 7",
            "Learning curve of the serve on the simulated robot: what happened, and what its "
            "cameras saw. " + _CURVE + "Where the landing leaps, the ball has jumped off the "
            "goal's ring. Marks: exploration for J_H and for J_G. Below: all runs.",
            "Two curves over the trials, and dots for what the cameras saw: d falls soon, the "
            "landing later and with leaps; exploration trials are marked below, then come the same "
            "curves of all runs.",
        ),
        Picture(
            "figure11.png",
            "Our Fig. 11",
            "The simulated robot of the upswing: the arm, the line along which its hand moves, and "
            "the pendulum in the hand, at an angle theta from the upright.",
            "The arm from the front and from the right, its hand on a horizontal line, a pendulum "
            "at an angle theta from the upright.",
        ),
        Picture(
            "figure12.png",
            "Our Fig. 12",
            "First trial of the upswing. Left: the pendulum's movement. Right: hand (with the "
            "via-points) and tip, angle and angular velocity. Dotted: the demonstration.",
            "A stroboscopic picture of the pendulum that does not end upright, and three curves "
            "over time that leave the demonstrated ones.",
        ),
        Picture(
            "figure13.png",
            "Our Fig. 13",
            "Learning curves of the upswing, the error at the end. Crosses: angle. Circles: "
            "speed. The Jacobian is kept (upper), explored again at given trials (middle), "
            "or estimated from the last trials (lower). Below each: trials made to explore.",
            "Three panels of two curves over sixty trials: the upper ones fall late, the lowest "
            "soonest.",
        ),
        Picture(
            "figure14.png",
            "Our Fig. 14",
            "Trial 30 of the upswing, as Fig. 12.",
            "A stroboscopic picture of the pendulum, and three curves over time beside the "
            "demonstrated ones.",
        ),
        Picture(
            "upswing_persons.png",
            "The upswing from many persons",
            "How many virtual persons' upswings have succeeded after so many trials, by the "
            "paper's equation and in Drake's plant.",
            "Two panels of three rising staircases, one for each way to the Jacobian, and a table "
            "of the shares.",
        ),
        Picture(
            "upswing_curves.png",
            "Learning curves of many upswings",
            "The larger of the two errors, in tolerances, of every virtual person's run. Thin: "
            "single runs. Band and line: quartiles and median.",
            "Six panels of bundled curves, for three ways and two executions: the medians fall "
            "below one tolerance; where the Jacobian is explored again, explorations are peaks.",
        ),
    )
}
"""Every picture that ``reproduce`` may draw, by the name of its file."""


def captioned(*files: str) -> tuple[Picture, ...]:
    """The pictures in some files."""
    return tuple(PICTURES[file] for file in files)
