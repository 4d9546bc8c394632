"""Systems of FMUs in the formats of other tools: SSP, OSP, and one container FMU."""
