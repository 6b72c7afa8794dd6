"""The benchmark set: workpieces, toolkits and their complete lists, for others to compare programs with."""
