"""The run queue: fair shares, waiting times, and runs that share a pass."""
