"""Control problems and what answers are held against, for studies."""
