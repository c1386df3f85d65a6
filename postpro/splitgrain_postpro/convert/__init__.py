"""Scripts of LMGC90 to keys of decks."""
