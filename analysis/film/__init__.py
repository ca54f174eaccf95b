"""Images of a game from above, and films of them."""
