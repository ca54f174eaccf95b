"""The world: arena, compiled motion kernel, and the Mesa model of a game on SimPy's clock."""
