"""The FMU: its description, its Python slave and the builder that packs both."""
