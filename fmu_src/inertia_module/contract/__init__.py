"""What outsiders rely on: variables, messages, models."""
