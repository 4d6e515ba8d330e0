"""What a sketch is made of: its files, libraries, project and board, and what is unsupported."""
