"""Constraints of a beat on the network in one window: poses, places and hands at some frames."""
