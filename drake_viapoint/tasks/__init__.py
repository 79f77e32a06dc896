"""What the robot learns: scenes, trials and their outcomes, task variables, subtasks."""
