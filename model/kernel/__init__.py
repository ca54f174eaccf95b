"""The compiled kernel: contacts, sensing and motion of all bodies in one control period."""
