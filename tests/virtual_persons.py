"""Persons and their serves into the goal of the shipped scene, practised once."""

from functools import cache

import numpy as np

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.tasks.serve_person import PersonServe, ServePerson, draw_person, practise
from drake_viapoint.tasks.serve_recording import record_person

GOAL = np.array([0.4, 2.35, 0.5])


@cache
def person_and_serve(number: int) -> tuple[ServePerson, PersonServe]:
    person = draw_person(number)
    return person, practise(person, GOAL)


@cache
def recorded(number: int) -> MarkerRecording:
    return record_person(number, GOAL)
