"""Language server of model files: diagnostics, completion, hover, renaming and formatting in editors that speak LSP.

It turns messages of the Language Server Protocol into calls of :mod:`torsionnet.app.text` and their answers into
messages; what a model says is decided there. It needs the extra ``lsp``.
"""
