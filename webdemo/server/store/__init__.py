"""Storage: the database, the history of runs, and files that expire."""
