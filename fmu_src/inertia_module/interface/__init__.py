"""Contract with other programs: variables, messages, models."""
