"""Files: texts and tables read with clear errors, written whole, and folders of vehicles."""
