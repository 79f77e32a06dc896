"""Movements as a handful of points in time, and the smoothest path through them."""
