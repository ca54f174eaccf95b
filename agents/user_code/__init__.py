"""User-defined code: syntax of references and loading of classes."""
