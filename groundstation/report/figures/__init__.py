"""The paper's figures 9 to 13, drawn from a flight's series: pure, each on axes that it is given."""
