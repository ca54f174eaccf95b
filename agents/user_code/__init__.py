"""Code of users: how a text names a class with arguments, and how its file is loaded."""
