"""Where the repository keeps what the research tools read and write."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GEN = ROOT / "gen"
LIB = ROOT / "lib"
DOCS = ROOT / "docs"
EXAMPLES = ROOT / "examples" / "data"
