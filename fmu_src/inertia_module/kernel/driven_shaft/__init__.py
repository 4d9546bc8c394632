"""The driven shaft: the elastic output as a model of its own."""
