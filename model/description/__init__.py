"""One game as data: swarms, arena, free parameters."""
