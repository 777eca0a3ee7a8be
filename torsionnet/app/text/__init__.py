"""Services on the text of a model file, also a broken one: completion, faults, hover, renaming, formatting, edits.

Each is a function from text to text or to data; the page of ``torsionnet explore`` and the language server call them.
Offsets count characters of the text from 0.
"""
