"""Teach a robot a dynamic skill from one demonstration and a few tens of trials."""

__version__ = "0.1.0"
