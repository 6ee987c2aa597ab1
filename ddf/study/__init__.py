"""Studies of the method itself: what speed costs in accuracy, and where the method fails."""
