"""CITATION.cff says what a citation needs, and says it of this version."""

import yaml
from markdown_pages import ROOT

from drake_viapoint import __version__


def test_citation() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation.keys() >= {"cff-version", "message", "title", "authors"}  # those required
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == __version__
    assert citation["license"] == "BSD-3-Clause"
    assert citation["authors"] == [{"name": "the drake-viapoint authors"}]
    (paper,) = citation["references"]
    assert [author["family-names"] for author in paper["authors"]] == ["Miyamoto", "Kawato"]
    assert (paper["journal"], paper["volume"], paper["year"]) == ("Neural Networks", 11, 1998)
