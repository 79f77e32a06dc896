"""Arms: their kinematics, the way from a tool path to joints, and the control that follows it."""
