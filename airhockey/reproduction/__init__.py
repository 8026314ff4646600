"""Chapter 5 of the thesis, run again: what it prints, the runs that each table and figure needs, and the page that compares."""
