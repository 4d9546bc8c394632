"""Contract with outsiders: variables, messages, models."""
