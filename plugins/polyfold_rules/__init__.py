"""The grammar and geometry behind the ``rules`` backend: words to folds, and folds to fold lines."""
