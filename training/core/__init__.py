"""The common part of all trainers: the loop, checkpoints, command lines, features of the captions."""
