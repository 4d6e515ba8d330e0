"""Sources of components: the index, classes of files, tables of values."""
