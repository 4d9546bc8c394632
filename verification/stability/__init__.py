"""How the module stands extremes: a map of cases, each with a verdict (exact, degraded, rejected)."""
