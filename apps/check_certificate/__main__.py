"""Checks the certificates of results of `accdec design` in exact rational arithmetic, by formulas of its own. Says what
is proved of each, or why nothing is; exit 0 if all are accepted, 1 if any is not, 2 on a file that cannot be read.
Designs themselves are not checked: `accdec verify` simulates them. Needs Python 3.9 and nothing else."""
import argparse
import sys

sys.dont_write_bytecode = True
from claim import check  # noqa: E402
from enclosure import NotCovered, Refused  # noqa: E402

parser = argparse.ArgumentParser(prog="python3 apps/check_certificate", description=__doc__)
parser.add_argument("results", nargs="+", metavar="RESULT.json")
worst = 0
sys.setrecursionlimit(20000)
for file in parser.parse_args().results:
    try:
        with open(file, encoding="utf-8") as opened:
            print(f"{file}: proved: {check(opened.read())}")
    except Refused as reason:
        print(f"{file}: {'not covered' if isinstance(reason, NotCovered) else 'refused'}: {reason}")
        worst = max(worst, 1)
    except (OSError, UnicodeDecodeError) as error:
        print(f"{file}: {error}", file=sys.stderr)
        worst = 2
sys.exit(worst)
