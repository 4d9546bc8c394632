"""The motion by events: steps of embedded pairs, each up to the first event in it."""
