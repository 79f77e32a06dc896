"""Task-level learning with numpy alone: no simulator, no task, no file."""
