"""Words: text to tagged tokens and noun phrases, with spelling, plainer wording and idle remarks taken care of."""
