"""Parts that are shipped, a file each, and those of packages and of users' files."""
