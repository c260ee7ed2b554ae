"""Version of the package: that of the program in CMakeLists.txt, as a test makes sure."""

__version__ = "1.1.0"
