"""The live page: a game that is watched while it is played (`kswarms explore`)."""
