"""The way of every HTTP request: limits, checks, pages of the lab's own, health and metrics."""
