"""The serve in simulation beside what the paper says of it (sections 2.1.1, 2.2 and 3.2)."""

from __future__ import annotations

from collections.abc import Sequence

from drake_viapoint.learning.selection import Selection
from drake_viapoint.reproduction.components import ServeComponents
from drake_viapoint.reproduction.disturbed_serve import ConditionResult, PairedResult
from drake_viapoint.reproduction.findings import Comparison, Verdict, judged
from drake_viapoint.reproduction.split_test import SURE
from drake_viapoint.reproduction.trials_needed import trials_in_words
from drake_viapoint.tasks.serve_demonstration import WatchedServe

_S_H = ("x3", "y3", "z3", "x4", "y4", "z4")
_S_G = ("phi6", "phi7", "psi7")


def serve_comparison(
    watched: WatchedServe, learned_at: int | None, found: ServeComponents | None
) -> tuple[Comparison, ...]:
    """Demonstration, via-points, and the components chosen.

    Args:
        watched: The demonstration.
        learned_at: Trial at which the serve was learned; None if it was not.
        found: What components do; None if the throw was not learned.
    """
    recording, extraction = watched.recording, watched.extraction
    points = len(extraction.via_points.times)
    rows = [
        Comparison(
            "markers of the demonstration",
            "2.1.1",
            "250 Hz, off by a few mm; a person",
            f"{recording.rate:g} Hz; {'synthetic' if watched.synthetic else 'a recording'}",
            Verdict.NOT_COMPARABLE if watched.synthetic else Verdict.MATCHES,
            "no recording of the paper's is public; a virtual person is measured as its subject was"
            if watched.synthetic
            else "",
        ),
        Comparison(
            "via-points, ends included",
            "2.1.1, Fig. 4",
            "8",
            f"{points}, at most {1000 * extraction.worst_errors[-1]:.0f} mm off, angles by a lever",
            judged(points == 8),
            "as many are asked for; what tells is the error that they leave",
        ),
        Comparison(
            "learning with S_G = (φ6 φ7 ψ7)",
            "2.2.2",
            "converges stably",
            f"learned at trial {learned_at}" if learned_at else "not learned",
            judged(learned_at is not None),
            "the paper gives no count for its simulation",
        ),
    ]
    if found is not None:
        rows += [
            _chosen("components that throw", "2.2.1, Fig. 9", _S_H, found.throw),
            _chosen("components that aim, by ratio", "2.2.2, Fig. 9", _S_G, found.by_ratio),
        ]
    return tuple(rows)


def conditions_comparison(
    results: Sequence[ConditionResult], pairs: Sequence[PairedResult], explored: str
) -> tuple[Comparison, ...]:
    """The three conditions of section 3.2.

    Args:
        results: Of the shipped study: undisturbed, kept, recorded.
        pairs: Each later condition against each earlier one.
        explored: By how much, in words.
    """
    undisturbed, kept, recorded = results
    compared = {(pair.condition, pair.other): pair for pair in pairs}
    return (
        Comparison(
            f"condition 1, undisturbed ({explored})",
            "3.2, Fig. 10",
            "stable, rapid",
            _learned(undisturbed),
            judged(undisturbed.learned > 0.5),
            f"{undisturbed.unreachable:.1f} trials a run were out of the arm's reach"
            if undisturbed.learned < 1.0
            else "",
        ),
        _compared(
            f"condition 2, Jacobians kept ({explored})",
            "unstable, slow",
            _learned(kept),
            compared["kept", "undisturbed"],
            better=False,
        ),
        _compared(
            f"condition 3, Jacobians estimated anew ({explored})",
            "stable, rapid",
            _learned(recorded),
            compared["recorded", "kept"],
            better=True,
        ),
        Comparison(
            f"exploration trials wasted under condition 2 ({explored})",
            "3.2",
            "a great number, from 9 to 43",
            f"{kept.wasted:.1f} a run, on average",
            judged(kept.wasted >= 9),
            "here the throw is left only when d < 3 cm, so nearly every ball may be used"
            if kept.wasted < 9
            else "",
        ),
    )


def _chosen(quantity: str, where: str, paper: tuple[str, ...], ours: Selection) -> Comparison:
    same = set(paper) == set(ours.control)
    return Comparison(
        quantity,
        where,
        _greek(paper),
        _greek(ours.control),
        judged(same),
        "" if same else "another person's movement: its throw and hit lie between other via-points",
    )


def _compared(
    quantity: str, paper: str, ours: str, pair: PairedResult, *, better: bool
) -> Comparison:
    """A condition that the paper finds better or worse than another, judged by pairs of runs."""
    counts = (
        f"of {pair.pairs} pairs of runs sooner than {pair.other} in {pair.sooner}, later in "
        f"{pair.later} (p = {pair.p_sooner:.2g}); alone learned in {pair.only_this}, not learned "
        f"alone in {pair.only_other} (p = {pair.p_value:.2g})"
    )
    if pair.p_sooner < SURE:
        same = (pair.sooner > pair.later) == better
        return Comparison(quantity, "3.2, Fig. 10", paper, ours, judged(same), counts)
    return Comparison(
        quantity,
        "3.2, Fig. 10",
        paper,
        ours,
        Verdict.NOT_COMPARABLE,
        f"no difference in speed that so many runs would show: {counts}",
    )


def _learned(result: ConditionResult) -> str:
    return (
        f"{result.learned:.0%} of {result.runs} learned ({result.learned_low:.0%} to "
        f"{result.learned_high:.0%}), median trial {trials_in_words(result.median)}; then "
        f"{100 * result.residual:.1f} cm off, of which {100 * result.floor:.1f} cm are the "
        "disturbance's"
    )


def _greek(components: Sequence[str]) -> str:
    text = " ".join(components)
    for word, letter in (("phi", "φ"), ("theta", "θ"), ("psi", "ψ")):
        text = text.replace(word, letter)
    return text
