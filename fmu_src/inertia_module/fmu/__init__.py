"""The FMUs: model descriptions, the Python slave, and the builder of the FMU files."""
