"""From a marker file to the pose of the racket and the time of the hit (paper 2.1.1)."""
