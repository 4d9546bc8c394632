"""The motion by events: steps of embedded pairs or a stiff method, each up to the first switch in it."""
