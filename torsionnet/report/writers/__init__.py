"""Writers of a report: HTML, LaTeX, Markdown, and PDF through a browser."""
