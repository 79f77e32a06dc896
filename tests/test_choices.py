"""The study of how components are chosen: a person's runs are runs, and nothing is done twice."""

from pathlib import Path

import pytest

from drake_viapoint.reproduction.choices import PersonChoice, choices_summary, study_choices
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.serve import ServeTask


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("choices") / "choices.jsonl"


def test_a_persons_serve_with_each_choice(file: Path) -> None:
    told: list[int] = []
    (shipped,) = study_choices(file, 1, workers=1, on_person=told.append)
    assert told == [0, 1]
    assert shipped.person == 0
    assert len(shipped.norm.split()) == len(shipped.ratio.split()) == 3
    assert shipped.norm != shipped.ratio
    assert shipped.as_given is not None
    changes = {"learning.strike.control": shipped.ratio.split(), "learning.repeats": 0}
    alone = learn(
        ServeTask(task_scenario("serve", None, changes)), MemoryLog("alone"), seed=0, max_trials=60
    )
    assert shipped.by_ratio == alone.learned_at

    before = file.stat().st_mtime_ns
    assert study_choices(file, 1, workers=1) == [shipped]
    assert file.stat().st_mtime_ns == before


def test_counts() -> None:
    results = [
        PersonChoice(0, 30, "x3 y3 y5", None, "psi6 psi7 psi8", 25),
        PersonChoice(1, None, "x3 y3 y5", None, "psi6 psi7 psi8", 27),
    ]
    assert choices_summary(results) == [
        "S_G chosen as the scenario says: 1 of 2 serves learned within 60 trials, "
        "those by trial 30 (median), 30 (worst)",
        "S_G chosen by norm: 0 of 2 serves learned within 60 trials",
        "S_G chosen by ratio: 2 of 2 serves learned within 60 trials, those by trial 26 (median), "
        "27 (worst)",
    ]
    nobody = choices_summary([])
    assert nobody[1] == "S_G chosen by norm: 0 of 0 serves learned within 60 trials"
