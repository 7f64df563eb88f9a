"""Reports on flights: the paper's experiments, one flight, several compared; as a page and as a PDF."""
