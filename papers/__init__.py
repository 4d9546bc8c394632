"""The three source papers: every equation as printed and exact, every claim with its verdict."""
