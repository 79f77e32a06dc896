"""Learning runs: ask the learner, execute the trial, record it; resume what was interrupted."""
