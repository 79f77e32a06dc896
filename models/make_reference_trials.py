"""Writes reference_trials.yaml: where the shipped scenarios' first trials end, and their bits here.

Bits of other versions and machines stay as they are. To be run whenever a shipped trial is changed
on purpose, with every Python supported: ``.venv/bin/python models/make_reference_trials.py``.
"""

from pathlib import Path
from typing import Any

import yaml

from drake_viapoint.reproduction.installation import first_trial, this_kind
from drake_viapoint.tasks.catalogue import TASKS

FILE = Path(__file__).with_name("reference_trials.yaml")
HEAD = """\
# Where the first trials of the shipped scenarios end, and digests of their records by what their
# bits hang on: `drake-viapoint doctor` compares. Made by make_reference_trials.py.
"""


def main() -> None:
    """Add what this installation gives."""
    here = this_kind()
    old = yaml.safe_load(FILE.read_text()) if FILE.exists() else {}
    data: dict[str, Any] = {}
    for task in TASKS:
        end, digest = first_trial(task)
        others = [
            row
            for row in old.get(task, {}).get("bits", [])
            if {name: row[name] for name in here} != here
        ]
        data[task] = {"end": end, "bits": [*others, {**here, "sha256": digest}]}
        print(f"{task}: ends at {end}")
    FILE.write_text(HEAD + yaml.safe_dump(data, sort_keys=False))


if __name__ == "__main__":
    main()
