"""Check of the files that a release needs beside the package: ``make release-files``."""
