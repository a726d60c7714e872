"""Words of fold language: tokens, spelling, phrases and what is left out."""
