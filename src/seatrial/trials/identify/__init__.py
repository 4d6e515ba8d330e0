"""From a log to parameters: the files, what is done with them, and the page that shows it."""
