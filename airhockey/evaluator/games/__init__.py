"""Games of two players: played, judged, and kept; matches are games of one pair, tournaments of many."""
