"""How a report is written: HTML, LaTeX, Markdown, and PDF through a browser."""
