"""Version of the package: that of the program in CMakeLists.txt, as a test makes sure."""

__version__ = "0.1.0"
