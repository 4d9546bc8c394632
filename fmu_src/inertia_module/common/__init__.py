"""Common to every floor: errors, files, quantities with units, the terminal."""
