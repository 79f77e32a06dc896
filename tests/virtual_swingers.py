"""Persons and their upswings, practised once."""

from functools import cache

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.tasks.upswing_person import PersonUpswing, UpswingPerson, draw_person
from drake_viapoint.tasks.upswing_recording import record_person, upswing_of


@cache
def person_and_upswing(number: int) -> tuple[UpswingPerson, PersonUpswing]:
    return draw_person(number), upswing_of(number)


@cache
def recorded(number: int) -> MarkerRecording:
    return record_person(number)
