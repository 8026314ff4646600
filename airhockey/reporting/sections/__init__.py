"""The sections of a page: each turns what was aggregated into headings, sentences, drawings and tables."""
