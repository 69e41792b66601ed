"""What every HTTP request meets: limits, checks, pages of the lab's own, health and metrics."""
