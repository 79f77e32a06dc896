"""The paper's figures from our runs, and what a person looks at: pictures and recordings."""
