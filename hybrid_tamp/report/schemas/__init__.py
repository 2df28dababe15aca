"""Published JSON Schemas of the documents that the command line prints and writes."""
