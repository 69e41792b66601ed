"""What a beat gives the network in one window: poses, places and hands at some frames."""
