"""The networks, one file a paper. Import the file that you need: each loads torch."""
