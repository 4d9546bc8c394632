"""What every floor uses: errors, files, quantities with units, the terminal."""
