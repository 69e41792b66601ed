"""What all trainers share: the loop, checkpoints, command lines, features of the captions."""
