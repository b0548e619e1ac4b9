"""Reference impacts: an open suite of certified impacts, and the score of another code's histories against it."""
