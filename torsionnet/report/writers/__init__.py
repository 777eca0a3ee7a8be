"""Writers of a report into HTML, LaTeX, Markdown, and through a browser into pdf."""
