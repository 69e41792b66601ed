"""The run queue: fair shares and waiting times."""
