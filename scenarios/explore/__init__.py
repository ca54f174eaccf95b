"""The page of `kswarms explore`, which shows a game while it is played."""
